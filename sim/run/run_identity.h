/// Runs of several points that are the same: those of cases which a sweep does not change.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/config/value.h"

namespace servomill::strategies {
class Strategy;
}  // namespace servomill::strategies
namespace servomill::sim::engine {
struct CaseInputs;
}  // namespace servomill::sim::engine
namespace servomill::sim::preparation {
class PreparedCase;
}  // namespace servomill::sim::preparation

namespace servomill::sim::run {

/// All that a run depends on: what was prepared for it, by its place in memory, and the document
/// of its scenario but for the other cases, the quantities and the errors. (Of the errors it sees
/// what was prepared.)
class RunIdentity {
 public:
  /// @param prepared  must outlive this, and have been prepared with the cache of those compared
  /// @param inputs    of the run; only looked at
  /// @param number    of the case in its scenario, from 0
  RunIdentity(const preparation::PreparedCase& prepared, const engine::CaseInputs& inputs,
              std::size_t number);

  /// True only if both have the same result, bit for bit.
  bool is_same_as(const RunIdentity& other) const;

 private:
  const config::Value& document() const;

  // document of the scenario; nullptr if the run depends on more than this knows
  const std::string* resolved_ = nullptr;
  std::size_t number_ = 0;
  std::vector<const void*> prepared_;
  std::string outputs_;
  mutable std::optional<config::Value> document_;  // read when all else is the same
};

/// The resolved document of a scenario without its tables `errors`, `quantity` and `sweep`, and of
/// its cases with this one only.
config::Value document_of_run(std::string_view toml, std::size_t number);

}  // namespace servomill::sim::run

/// The list of strategies. Allowed names, keys, help texts and error messages all follow from it.
#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "plant/vocabulary/parameters.h"
#include "strategies/strategy.h"

namespace servomill::strategies {

struct Entry {
  std::string_view name;
  std::string_view summary;
  std::span<const ParameterSpec> parameters;
  /// @throws InputError without a place when the parameters contradict the belief
  std::unique_ptr<Strategy> (*make)(const Parameters&, Sign, const Belief&);
  bool reads_gains = false;  ///< false: Belief::Kv is NaN, so that nothing depends on it
  bool reads_errors = true;  ///< false: knows no geometric errors, and takes neither model nor sign
};

/// All strategies, sorted by name.
std::span<const Entry> entries();

/// The entry of that name, or nullptr.
const Entry* find(std::string_view name);

std::vector<std::string_view> names();

}  // namespace servomill::strategies

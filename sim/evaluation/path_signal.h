/// The signed quantities along the path of a case, sample by sample: for budgets.
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

#include "sim/evaluation/case_samples.h"
#include "sim/evaluation/quantity.h"
#include "sim/model/forward.h"

namespace servomill::sim::evaluation {

/// A signed quantity at a sample of feed motion.
struct PathSample {
  double s = 0.0;       // mm, arc length of the original path, not falling
  double turned = 0.0;  // 0 to 1, of what rotary axes turn while s stands; 0 where it moves
  double value = 0.0;   // in the unit of the quantity
};

/// Tells if there is a PathSignal of a quantity: QuantityEntry::signal.
bool has_path_signal(std::string_view quantity);

/// Samples over which the statistic of a quantity is taken, one by one; nothing is kept of them.
class PathSignal {
 public:
  /// @param one, base  the recordings must outlive it; base: the case it is compared with, nullptr
  ///                   if it needs none
  /// @pre has_path_signal(spec.name), and both cases have finished
  PathSignal(const model::QuantitySpec& spec, const CaseData& one, const CaseData* base);
  PathSignal(PathSignal&&) noexcept;
  ~PathSignal();

  /// Samples; 0 also if what it takes was not recorded.
  std::size_t size() const;
  /// The next sample; false behind the last.
  bool next(PathSample& sample);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace servomill::sim::evaluation

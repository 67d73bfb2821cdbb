/// The last position periods of a case.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "sim/records/series.h"

namespace servomill::sim::engine {

/// Kept in a ring, so that a case that stops can be looked into.
class LastTicks {
 public:
  /// @param joints  of the machine
  explicit LastTicks(std::vector<int> joints) : present_(std::move(joints)) {
    ring_.resize(kLastTicks * kPerRow);
  }
  /// One position period (s; m, rad; A).
  void keep(double time, const Joints& Q_cmd, const Joints& Q_fb, const Joints& Q_true,
            const Joints& current);
  records::Series series(const JointLayout& layout) const;

 private:
  static constexpr std::size_t kLastTicks = 2000;  // position periods
  static constexpr std::size_t kPerRow = 1 + 4 * kJoints;
  std::vector<int> present_;
  std::vector<double> ring_;
  std::size_t count_ = 0;
};

}  // namespace servomill::sim::engine

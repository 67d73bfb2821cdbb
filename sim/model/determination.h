/// Corrections that a calibration determines, and those that it does not.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace servomill::sim::model {

/// Corrections of one quantity at several places. A correction helps where it is larger than its
/// expanded uncertainty. They are determined if the largest uncertainty does not exceed the largest
/// of those that are significant: a curve that passes through 0 is, one that is extrapolated far
/// beyond the readings is not.
class Determination {
 public:
  /// @param correction, expanded  in one unit
  void add(double correction, double expanded) {
    const double size = std::abs(correction);
    largest_ = std::max(largest_, size);
    uncertainty_ = std::max(uncertainty_, expanded);
    if (size >= expanded) significant_ = std::max(significant_, size);
  }

  bool is_determined() const { return uncertainty_ <= significant_; }
  double largest() const { return largest_; }          ///< magnitude of the corrections
  double uncertainty() const { return uncertainty_; }  ///< largest, expanded

 private:
  double largest_ = 0.0, significant_ = 0.0, uncertainty_ = 0.0;
};

/// Corrections of X, Y and Z of the tip.
class TipDetermination {
 public:
  /// @param correction, expanded  (3; m)
  void add(const Eigen::Vector3d& correction, const Eigen::Vector3d& expanded) {
    for (int i = 0; i < 3; ++i) of_[std::size_t(i)].add(correction[i], expanded[i]);
  }

  const Determination& of(int i) const { return of_[std::size_t(i)]; }

  /// First coordinate that is not determined, although it is corrected by a tenth of the largest
  /// correction of all or more: less does no harm.
  /// @param left  coordinates that are not corrected
  std::optional<int> undetermined(const std::array<bool, 3>& left = {}) const {
    constexpr double kMatters = 0.1;
    double most = 0.0;
    for (const Determination& one : of_) most = std::max(most, one.largest());
    for (int i = 0; i < 3; ++i) {
      if (left[std::size_t(i)]) continue;
      if (!of(i).is_determined() && of(i).largest() > kMatters * most) return i;
    }
    return std::nullopt;
  }

 private:
  std::array<Determination, 3> of_;
};

}  // namespace servomill::sim::model

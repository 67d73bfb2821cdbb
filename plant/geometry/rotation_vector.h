/// The turn of a vector of angles.
#pragma once

#include <Eigen/Core>

namespace servomill::plant {

/// Rot(e), the exponential of [e]x: Rot v = v + a e x v + b e x (e x v), with a = sin t/t,
/// b = (1 - cos t)/t^2 for t = |e|.
class TurnOf {
 public:
  explicit TurnOf(const Eigen::Vector3d& e);  ///< e: rad
  Eigen::Vector3d operator*(const Eigen::Vector3d& v) const;
  Eigen::Matrix3d matrix() const;

  /// Angular velocity when e changes at the rate de: de + b e x de + c e x (e x de), with
  /// c = (1 - a)/t^2.
  Eigen::Vector3d velocity(const Eigen::Vector3d& de) const;

 private:
  static constexpr double kSeries = 1e-3;  // rad^2: the next term is below 1e-17
  Eigen::Vector3d e_;
  double t2_, a_, b_;
};

}  // namespace servomill::plant

#include "plant/geometry/rotation_vector.h"

#include <Eigen/Geometry>
#include <cmath>

namespace servomill::plant {

using Eigen::Matrix3d;
using Eigen::Vector3d;

TurnOf::TurnOf(const Vector3d& e) : e_(e), t2_(e.squaredNorm()) {
  if (t2_ < kSeries) {
    a_ = 1.0 + t2_ * (-1.0 / 6.0 + t2_ * (1.0 / 120.0 - t2_ * (1.0 / 5040.0)));
    b_ = 0.5 + t2_ * (-1.0 / 24.0 + t2_ * (1.0 / 720.0 - t2_ * (1.0 / 40320.0)));
  } else {
    const double t = std::sqrt(t2_);
    a_ = std::sin(t) / t;
    b_ = (1.0 - std::cos(t)) / t2_;
  }
}

Vector3d TurnOf::operator*(const Vector3d& v) const {
  const Vector3d ev = e_.cross(v);
  return v + a_ * ev + b_ * e_.cross(ev);
}

Matrix3d TurnOf::matrix() const {
  Matrix3d R;
  for (int i = 0; i < 3; ++i) R.col(i) = *this * Vector3d::Unit(i);
  return R;
}

Vector3d TurnOf::velocity(const Vector3d& de) const {
  const double c =
      t2_ < kSeries ? 1.0 / 6.0 - t2_ * (1.0 / 120.0 - t2_ * (1.0 / 5040.0)) : (1.0 - a_) / t2_;
  const Vector3d ed = e_.cross(de);
  return de + b_ * ed + c * e_.cross(ed);
}

}  // namespace servomill::plant

#include "plant/structure/structural_deflection.h"

namespace servomill::plant {

StructuralDeflection::StructuralDeflection(const std::vector<StructuralMode>& modes) {
  for (const StructuralMode& one : modes) {
    if (one.is_static()) {
      compliance_ += one.compliance * one.direction * one.direction.transpose();
    } else {
      modes_.push_back({.mode = one});
    }
  }
}

void StructuralDeflection::advance(double dt, const Eigen::Vector3d& F) {
  for (Resonance& one : modes_) {
    if (dt > 0.0) {
      if (one.h != dt) one.step = mode_step(one.mode.mode, dt);
      one.h = dt;
      const ModeState next = one.step.from({one.away, one.speed}, {});
      one.away = next.eta;
      one.speed = next.deta;
    }
    const double balance = one.mode.compliance * one.mode.direction.dot(F);
    one.away += one.balance - balance;
    one.balance = balance;
  }
  force_ = F;
}

Eigen::Vector3d StructuralDeflection::after(double dt) const {
  Eigen::Vector3d d = compliance_ * force_;
  for (const Resonance& one : modes_) {
    double away = one.away;
    if (dt > 0.0) away = mode_step(one.mode.mode, dt).from({one.away, one.speed}, {}).eta;
    d += (one.balance + away) * one.mode.direction;
  }
  return d;
}

Eigen::Vector3d StructuralDeflection::of_modes() const {
  Eigen::Vector3d d = Eigen::Vector3d::Zero();
  for (const Resonance& one : modes_) d += (one.balance + one.away) * one.mode.direction;
  return d;
}

Eigen::Matrix3d static_compliance(const std::vector<StructuralMode>& modes,
                                  const Eigen::Vector3d& of_axes) {
  return Eigen::Matrix3d(of_axes.asDiagonal()) + StructuralDeflection(modes).static_compliance();
}

}  // namespace servomill::plant

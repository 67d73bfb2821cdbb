#include "plant/structure/tool_point_vibration.h"

#include <cmath>

namespace servomill::plant {

// q'' + 2 zeta w q' + w^2 q = w^2 / k f: about its static deflection f / k it decays freely.
ToolPointVibration::ToolPointVibration(const std::vector<StructuralMode>& modes, double step) {
  for (const StructuralMode& mode : modes) {
    if (mode.is_static()) continue;
    const double w = mode.mode.w, z = mode.mode.zeta, wd = w * std::sqrt(1.0 - z * z);
    const double e = std::exp(-z * w * step), c = std::cos(wd * step), s = std::sin(wd * step);
    Oscillator one{.direction = mode.direction,
                   .q_q = e * (c + z * w / wd * s),
                   .q_dq = e * s / wd,
                   .dq_q = -e * w * w / wd * s,
                   .dq_dq = e * (c - z * w / wd * s),
                   .q_f = 0.0,
                   .dq_f = 0.0};
    one.q_f = (1.0 - one.q_q) * mode.compliance;
    one.dq_f = -one.dq_q * mode.compliance;
    modes_.push_back(one);
  }
}

ToolPointVibration::State ToolPointVibration::now() const {
  State out;
  for (const Oscillator& one : modes_) {
    out.x += one.q * one.direction;
    out.dx += one.dq * one.direction;
  }
  return out;
}

ToolPointVibration::State ToolPointVibration::after(const Eigen::Vector3d& force) const {
  State out;
  for (const Oscillator& one : modes_) {
    const double f = force.dot(one.direction);
    out.x += one.next_q(f) * one.direction;
    out.dx += one.next_dq(f) * one.direction;
  }
  return out;
}

void ToolPointVibration::advance(const Eigen::Vector3d& force) {
  for (Oscillator& one : modes_) {
    const double f = force.dot(one.direction), q = one.next_q(f);
    one.dq = one.next_dq(f);
    one.q = q;
  }
}

Eigen::Vector3d ToolPointVibration::between(const State& a, const State& b, double step,
                                            double share) {
  const double u = share, v = 1.0 - share;
  return v * v * (1.0 + 2.0 * u) * a.x + u * u * (1.0 + 2.0 * v) * b.x +
         step * (u * v * v * a.dx - u * u * v * b.dx);
}

}  // namespace servomill::plant

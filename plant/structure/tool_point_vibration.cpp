#include "plant/structure/tool_point_vibration.h"

namespace servomill::plant {

ToolPointVibration::ToolPointVibration(const std::vector<StructuralMode>& modes, double step) {
  for (const StructuralMode& mode : modes) {
    if (mode.is_static()) continue;
    modes_.push_back({mode.direction, mode.compliance, mode_step(mode.mode, step), {}});
  }
}

// About the deflection that a constant force holds a mode decays freely.
ModeState ToolPointVibration::Oscillator::after(double f) const {
  const double held = compliance * f;
  ModeState next = free.from({now.eta - held, now.deta}, {});
  next.eta += held;
  return next;
}

ToolPointVibration::State ToolPointVibration::now() const {
  State out;
  for (const Oscillator& one : modes_) {
    out.x += one.now.eta * one.direction;
    out.dx += one.now.deta * one.direction;
  }
  return out;
}

ToolPointVibration::State ToolPointVibration::after(const Eigen::Vector3d& force) const {
  State out;
  for (const Oscillator& one : modes_) {
    const ModeState next = one.after(force.dot(one.direction));
    out.x += next.eta * one.direction;
    out.dx += next.deta * one.direction;
  }
  return out;
}

void ToolPointVibration::advance(const Eigen::Vector3d& force) {
  for (Oscillator& one : modes_) one.now = one.after(force.dot(one.direction));
}

Eigen::Vector3d ToolPointVibration::between(const State& a, const State& b, double step,
                                            double share) {
  const double u = share, v = 1.0 - share;
  return v * v * (1.0 + 2.0 * u) * a.x + u * u * (1.0 + 2.0 * v) * b.x +
         step * (u * v * v * a.dx - u * u * v * b.dx);
}

}  // namespace servomill::plant

#include "sim/engine/chip_regeneration.h"

#include <algorithm>
#include <cmath>

namespace servomill::sim::engine {

using State = plant::ToolPointVibration::State;

namespace {

std::size_t steps_held(double step, double longest) {
  // interpolation needs both neighbours of the farthest place
  constexpr double kSpare = 4.0;  // steps
  return static_cast<std::size_t>(std::ceil(plant::kPassagesBefore * longest / step) + kSpare);
}

}  // namespace

double ChipRegeneration::memory(double step, double longest) {
  return static_cast<double>(steps_held(step, longest) * sizeof(State));
}

ChipRegeneration::ChipRegeneration(const std::vector<plant::StructuralMode>& modes, double step,
                                   double longest, const Eigen::Matrix3d& held)
    : vibration_(modes, step),
      step_(step),
      held_(held),
      gives_way_(!held.isZero(0.0)),
      course_(steps_held(step, longest)),
      course_held_(gives_way_ ? course_.size() : 0, Eigen::Vector3d::Zero()) {}

void ChipRegeneration::begin(const Eigen::Matrix3d& J_pL) {
  J_pL_ = J_pL;
  begin_ = vibration_.now();
  newest_ = (newest_ + 1) % course_.size();
  // Kept in W: chip thickness compares with where the workpiece was cut, although rotary axes have
  // turned since.
  course_[newest_] = {J_pL * begin_.x, J_pL * begin_.dx};
  if (gives_way_) held_W_ = J_pL * held_ * J_pL.transpose();
}

void ChipRegeneration::end(const Eigen::Vector3d& force) {
  force_ = force;
  vibration_.advance(J_pL_.transpose() * force);
  end_ = vibration_.now();
  if (gives_way_) course_held_[newest_] = held_W_ * force;
}

// In W, so many steps before the present one has begun.
Eigen::Vector3d ChipRegeneration::past(double steps) const {
  const auto whole = static_cast<std::size_t>(std::ceil(steps));
  // Before the first cut nothing vibrated.
  if (whole >= course_.size()) return Eigen::Vector3d::Zero();
  const std::size_t size = course_.size();
  const State& a = course_[(newest_ + size - whole) % size];
  if (whole == 0) return a.x;
  const State& b = course_[(newest_ + size - whole + 1) % size];
  return plant::ToolPointVibration::between(a, b, step_, static_cast<double>(whole) - steps);
}

// The same of the static deflection, before the middle of the present step.
Eigen::Vector3d ChipRegeneration::past_held(double steps) const {
  const auto whole = static_cast<std::size_t>(std::ceil(steps));
  const std::size_t size = course_held_.size();
  if (whole >= size || whole == 0) return Eigen::Vector3d::Zero();
  const double share = static_cast<double>(whole) - steps;  // from the older one to the newer
  return (1.0 - share) * course_held_[(newest_ + size - whole) % size] +
         share * course_held_[(newest_ + size - whole + 1) % size];
}

// In the middle of the step under a force.
DisplacementsBefore ChipRegeneration::displacements(const Eigen::Vector3d& force,
                                                    const Eigen::Matrix3d& J_pL,
                                                    double passage) const {
  // The force of a step is that in its middle, which makes the step of second order.
  constexpr double kMiddle = 0.5;
  const State next = vibration_.after(J_pL.transpose() * force);
  const Eigen::Vector3d x = J_pL * plant::ToolPointVibration::between(begin_, next, step_, kMiddle);
  DisplacementsBefore out;
  for (std::size_t m = 0; m < out.size(); ++m) {
    const double passed = static_cast<double>(m + 1) * passage / step_;
    out[m] = x - past(passed - kMiddle);
    if (gives_way_) out[m] += held_W_ * force - past_held(passed);
  }
  return out;
}

Eigen::Vector3d ChipRegeneration::deflection(double after) const {
  const double share = std::clamp(after / step_, 0.0, 1.0);
  return plant::ToolPointVibration::between(begin_, end_, step_, share);
}

}  // namespace servomill::sim::engine

#include "sim/engine/chip_regeneration.h"

#include <algorithm>
#include <cmath>

namespace servomill::sim::engine {

using State = plant::ToolPointVibration::State;

namespace {

std::size_t steps_held(double step, double longest) {
  constexpr double kSpare = 4.0;  // steps
  return static_cast<std::size_t>(std::ceil(plant::kPassagesBefore * longest / step) + kSpare);
}

}  // namespace

double ChipRegeneration::memory(double step, double longest) {
  return static_cast<double>(steps_held(step, longest) * sizeof(State));
}

ChipRegeneration::ChipRegeneration(const std::vector<plant::StructuralMode>& modes, double step,
                                   double longest)
    : vibration_(modes, step), step_(step), course_(steps_held(step, longest)) {}

void ChipRegeneration::begin(const Eigen::Matrix3d& J_pL) {
  J_pL_ = J_pL;
  begin_ = vibration_.now();
  newest_ = (newest_ + 1) % course_.size();
  course_[newest_] = {J_pL * begin_.x, J_pL * begin_.dx};
}

void ChipRegeneration::end(const Eigen::Vector3d& force) {
  force_ = force;
  vibration_.advance(J_pL_.transpose() * force);
  end_ = vibration_.now();
}

// In W, so many steps before the present one has begun.
Eigen::Vector3d ChipRegeneration::past(double steps) const {
  const auto whole = static_cast<std::size_t>(std::ceil(steps));
  if (whole >= course_.size()) return Eigen::Vector3d::Zero();
  const std::size_t size = course_.size();
  const State& a = course_[(newest_ + size - whole) % size];
  if (whole == 0) return a.x;
  const State& b = course_[(newest_ + size - whole + 1) % size];
  return plant::ToolPointVibration::between(a, b, step_, static_cast<double>(whole) - steps);
}

// In the middle of the step, whose end is `next`.
DisplacementsBefore ChipRegeneration::displacements(const State& next, const Eigen::Matrix3d& J_pL,
                                                    double passage) const {
  constexpr double kMiddle = 0.5;
  const Eigen::Vector3d x = J_pL * plant::ToolPointVibration::between(begin_, next, step_, kMiddle);
  DisplacementsBefore out;
  for (std::size_t m = 0; m < out.size(); ++m) {
    out[m] = x - past(static_cast<double>(m + 1) * passage / step_ - kMiddle);
  }
  return out;
}

Eigen::Vector3d ChipRegeneration::deflection(double after) const {
  const double share = std::clamp(after / step_, 0.0, 1.0);
  return plant::ToolPointVibration::between(begin_, end_, step_, share);
}

}  // namespace servomill::sim::engine

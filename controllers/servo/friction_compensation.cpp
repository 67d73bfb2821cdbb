#include "controllers/servo/friction_compensation.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace servomill::controllers {
namespace {

constexpr double kSpent = 1e-9;  // of the pulse's height; what is left never becomes a denormal

double turned(double direction, double v, double v_switch) {
  if (v == 0.0) return direction;
  const double share = std::abs(v) < v_switch ? 2.0 * std::abs(v) / v_switch - 1.0 : 1.0;
  return v > 0.0 ? std::max(direction, share) : std::min(direction, -share);
}

}  // namespace

double friction_compensation(const FrictionCompensationParams& p, FrictionCompensationState& s,
                             double v) {
  assert(p.tau_pulse == 0.0 ||
         std::min(p.reversal_pulse_time, p.reversal_pulse_distance) < kNoLimit);
  const double before = s.direction;
  s.direction = turned(before, v, p.v_switch);
  if (before * s.direction < 0.0 || (before != 0.0 && s.direction == 0.0)) {
    s.pulse = std::copysign(1.0, v) * p.tau_pulse;
  } else if (s.pulse != 0.0) {
    s.pulse *=
        std::exp(-p.Tv / p.reversal_pulse_time - std::abs(v) * p.Tv / p.reversal_pulse_distance);
    if (std::abs(s.pulse) < kSpent * std::abs(p.tau_pulse)) s.pulse = 0.0;
  }
  return s.direction * (s.direction > 0.0 ? p.tau_plus : p.tau_minus) + s.pulse;
}

}  // namespace servomill::controllers

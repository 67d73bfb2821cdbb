#include "controllers/servo/friction_compensation.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace servomill::controllers {
namespace {

constexpr double kSpent = 1e-9;  // of the spike's height; what is left never becomes a denormal

double turned(double direction, double v, double v_switch) {
  if (v == 0.0) return direction;
  const double share = std::abs(v) < v_switch ? 2.0 * std::abs(v) / v_switch - 1.0 : 1.0;
  return v > 0.0 ? std::max(direction, share) : std::min(direction, -share);
}

}  // namespace

double friction_compensation(const FrictionCompensationParams& p, FrictionCompensationState& s,
                             double v) {
  assert(p.tau_spike == 0.0 || std::min(p.spike_time, p.spike_distance) < kNoLimit);
  const double before = s.direction;
  s.direction = turned(before, v, p.v_switch);
  if (before * s.direction < 0.0 || (before != 0.0 && s.direction == 0.0)) {
    s.spike = std::copysign(1.0, v) * p.tau_spike;
  } else if (s.spike != 0.0) {
    s.spike *= std::exp(-p.Tv / p.spike_time - std::abs(v) * p.Tv / p.spike_distance);
    if (std::abs(s.spike) < kSpent * std::abs(p.tau_spike)) s.spike = 0.0;
  }
  return s.direction * (s.direction > 0.0 ? p.tau_plus : p.tau_minus) + s.spike;
}

}  // namespace servomill::controllers

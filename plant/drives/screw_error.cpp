#include "plant/drives/screw_error.h"

#include <cmath>

namespace servomill::plant {

double ScrewGrowth::rise(double t) const {
  if (t < 0.0) return 0.0;
  return tau > 0.0 ? -dT_end * std::expm1(-t / tau) : dT_end;
}

double ScrewError::at(double x, double t) const {
  return lead.value(x) + growth.alpha * growth.rise(t) * (x - growth.x_fixed);
}

double ScrewError::slope(double x, double t) const {
  return lead.derivative(x) + growth.alpha * growth.rise(t);
}

bool ScrewError::is_zero() const { return lead.is_zero() && growth.alpha * growth.dT_end == 0.0; }

double motor_angle(const ScrewError& error, double r, double X_s, double t) {
  return (X_s - error.at(X_s, t)) / r;
}

std::vector<std::string> implausible(const ScrewGrowth& growth) {
  std::vector<std::string> faults;
  if (!(growth.alpha >= 0.0)) faults.emplace_back("alpha must be >= 0");
  if (!(growth.tau >= 0.0)) faults.emplace_back("tau must be >= 0");
  return faults;
}

}  // namespace servomill::plant

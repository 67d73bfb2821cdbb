#include "plant/heat/thermal_errors.h"

namespace servomill::plant {

ErrorModel at_temperatures(const ErrorModel& errors, const std::vector<ThermalError>& thermal,
                           const Eigen::VectorXd& T, double reference) {
  ErrorModel out = errors;
  for (const ThermalError& one : thermal) {
    out = out + scaled(one.per_kelvin, T[one.body] - reference);
  }
  return out;
}

}  // namespace servomill::plant

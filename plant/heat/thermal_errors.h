/// Geometric errors by the temperatures of a machine.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plant/geometry/error_model.h"

namespace servomill::plant {

/// Errors (of 1 K) that one body causes by its temperature: growth of a spindle is an EZ., tilt of
/// a column an EA., drift of the centre of a table an EX0C, expansion of a scale or of a screw that
/// the axis is measured with an EXX that grows with x.
struct ThermalError {
  int body = 0;
  ErrorModel per_kelvin;
};

/// errors + sum of (T_body - reference) per_kelvin; to first order expansion and bending add up.
/// @param T          of each body (K)
/// @param reference  K, at which the machine has the errors `errors`
ErrorModel at_temperatures(const ErrorModel& errors, const std::vector<ThermalError>& thermal,
                           const Eigen::VectorXd& T, double reference);

}  // namespace servomill::plant

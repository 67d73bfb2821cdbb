/// Normals of touched points, as tables have them.
#pragma once

#include <fmt/format.h>

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <string_view>

namespace servomill::sim::readings {

/// Gives a normal length 1 if rounding can explain the difference; else returns the fault.
/// @param columns  its three columns, for the message
inline std::string make_unit(Eigen::Vector3d& normal, std::string_view columns) {
  constexpr double kRounding = 1e-3;
  const double length = normal.norm();
  if (!(std::abs(length - 1.0) < kRounding)) {
    return fmt::format("{} have length {:.3g}; a normal must have length 1", columns, length);
  }
  normal /= length;
  return {};
}

}  // namespace servomill::sim::readings

/// Directions of the tool.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace servomill {

/// Angle between two directions (rad, 0 to pi), exact for small ones and near half a turn, too.
inline double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// A tool axis whose length differs from 1 by more is made a unit vector with a warning. Rounding
/// its components to four decimals, as CAM systems do, changes the length by up to 0.87e-4.
inline constexpr double kAxisLengthTolerance = 1e-4;

}  // namespace servomill

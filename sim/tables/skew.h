/// Matrix of a skew correction.
#pragma once

#include <Eigen/Core>

#include "sim/tables/table_residuals.h"

namespace servomill::sim::tables {

/// Commands x -= a y + b z, y -= c z that let the machine move along three lines at right angles.
///
/// With A the directions of motion of X, Y and Z of the machine with its location errors (columns)
/// and C the matrix of these commands, the columns of A C are orthogonal: X keeps its direction, Y
/// its plane with X. What remains is a rotation R of the frame, and lengths of second order.
struct SkewSettings {
  double a = 0.0, b = 0.0, c = 0.0;                   // rounded as written
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();    // frame of the corrected machine in W
  Eigen::Vector3d lengths = Eigen::Vector3d::Zero();  // of A C minus 1 (m/m)
  Volume volume;                                      // all errors, in the frame R
};

}  // namespace servomill::sim::tables

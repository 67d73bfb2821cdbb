/// Matrix of a skew correction.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "plant/geometry/error_model.h"
#include "sim/tables/table_residuals.h"

namespace servomill::sim::tables {

/// Commands x -= a y + b z, y -= c z that let the machine move along three lines at right angles.
///
/// With A the directions of motion of X, Y and Z of the machine with its location errors (columns)
/// and C the matrix of these commands, the columns of A C are orthogonal: X keeps its direction, Y
/// its plane with X. What remains is a rotation R of the frame, and lengths of second order.
struct SkewSettings {
  /// A factor that is not written, since the calibration does not determine it.
  struct LeftOut {
    std::array<plant::ErrorName, 2> squareness;  // as a turn of either axis
    double value = 0.0, uncertainty = 0.0;       // m/m; expanded (k = 2)
  };
  double a = 0.0, b = 0.0, c = 0.0;                   // rounded as written
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();    // frame of the corrected machine in W
  Eigen::Vector3d lengths = Eigen::Vector3d::Zero();  // of A C minus 1 (m/m)
  Volume volume;                                      // all errors, in the frame R
  std::optional<Eigen::Vector3d> uncertainty;         // of a, b, c (m/m), k = 2; none: not known
  std::vector<LeftOut> left_out;                      // 0 in a, b, c
};

}  // namespace servomill::sim::tables

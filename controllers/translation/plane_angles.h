/// Angles of tilted planes.
#pragma once

#include <Eigen/Core>
#include <array>

namespace servomill::controllers::translation {

/// Angles of G68.2, in degrees: about Z, the new X, the new Z.
std::array<double, 3> euler_angles(const Eigen::Matrix3d& R);

}  // namespace servomill::controllers::translation

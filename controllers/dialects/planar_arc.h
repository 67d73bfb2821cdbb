/// Arcs of programs: the tests that every control makes, or should.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

namespace servomill::controllers {

inline constexpr double kMaxRadiusDifference = 5e-6;  // m, between begin and end of an arc

/// Why a circle about a centre does not lead from one point to the other, or nothing.
/// @param begin, end, centre  X Y Z, m
std::optional<std::string> arc_fault(const Eigen::Vector3d& begin, const Eigen::Vector3d& end,
                                     const Eigen::Vector3d& centre, int normal_axis);

/// Length of the arc in its plane, m: a full circle where begin and end coincide.
double arc_length(const Eigen::Vector3d& begin, const Eigen::Vector3d& end,
                  const Eigen::Vector3d& centre, int normal_axis, int turns);

}  // namespace servomill::controllers

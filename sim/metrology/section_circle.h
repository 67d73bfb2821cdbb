/// A section of a program as one turn of a circle.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "sim/metrology/circle_fit.h"

namespace servomill::sim::metrology {

/// One turn of a circle in a principal plane of the workpiece.
struct SectionCircle {
  int first = 0, second = 1;  // axes of the plane, 0 X, 1 Y, 2 Z: XY, YZ or ZX
  Circle nominal;             // m

  /// Coordinates along the two axes.
  std::vector<Eigen::Vector2d> in_plane(std::span<const Eigen::Vector3d> points) const;
};

/// Continues "section 'NAME' ...".
struct NoCircle {
  std::string why;
};

/// The circle that the nominal tool centre point describes, by least squares.
/// @param nominal  its positions in the workpiece (m), sampled as the path will be
std::variant<SectionCircle, NoCircle> circle_of_section(std::span<const Eigen::Vector3d> nominal);

/// True if two sections go around the same centre with the same radius.
bool is_same_circle(const SectionCircle& one, const SectionCircle& other);

}  // namespace servomill::sim::metrology

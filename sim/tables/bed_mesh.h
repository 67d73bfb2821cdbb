/// Heights of a bed mesh, and of what remains with it.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "sim/tables/skew.h"

namespace servomill::sim::tables {

/// Corrections of Z at equidistant places of X and Y, at the reference of Z: with them and the skew
/// correction the tip moves in a plane.
struct BedMesh {
  int nx = 0, ny = 0;
  std::array<double, 4> range{};      // m: X from, to, Y from, to
  std::vector<double> z;              // m, rows along X; rounded as written
  double before = 0.0, after = 0.0;   // m: largest deviation of Z over the range
  std::optional<double> uncertainty;  // m: largest of z, expanded (k = 2); none: not known
};

}  // namespace servomill::sim::tables

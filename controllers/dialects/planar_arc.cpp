#include "controllers/dialects/planar_arc.h"

#include <fmt/format.h>

#include <cmath>

#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {

std::optional<std::string> arc_fault(const Eigen::Vector3d& begin, const Eigen::Vector3d& end,
                                     const Eigen::Vector3d& centre, int normal_axis) {
  const int a = (normal_axis + 1) % 3, b = (normal_axis + 2) % 3;
  const double r_begin = std::hypot(begin[a] - centre[a], begin[b] - centre[b]);
  const double r_end = std::hypot(end[a] - centre[a], end[b] - centre[b]);
  if (r_begin == 0.0) return "the centre of the arc is its start point";
  if (std::abs(r_begin - r_end) > kMaxRadiusDifference * (1.0 + 1e-6)) {
    return fmt::format("the arc starts at a radius of {:.4f} mm and ends at a radius of {:.4f} mm",
                       r_begin / mm, r_end / mm);
  }
  return std::nullopt;
}

double arc_length(const Eigen::Vector3d& begin, const Eigen::Vector3d& end,
                  const Eigen::Vector3d& centre, int normal_axis, int turns) {
  Eigen::Vector3d flat = end;
  flat[normal_axis] = begin[normal_axis];
  return ArcSweep(begin, flat, centre, normal_axis, turns).length();
}

}  // namespace servomill::controllers

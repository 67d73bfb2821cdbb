#include "controllers/gcode/arc_geometry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

constexpr double kSemicircleTol = 1e-12;  // relative; a chord this near the diameter is one
constexpr double kSpiralFactor = 100.0;   // beyond this many tolerances the relative one is unheard

}  // namespace

ArcCentre centre_format(const Eigen::Vector2d& start, const Eigen::Vector2d& end,
                        const Eigen::Vector2d& centre, const ArcTolerance& tolerance) {
  const double r_start = (start - centre).norm();
  const double r_end = (end - centre).norm();
  if (r_start < tolerance.radius || r_end < tolerance.radius) {
    return {centre, fmt::format("radius is zero: {:.4f} mm at the start, {:.4f} mm at the end",
                                r_start / mm, r_end / mm)};
  }
  const double difference = std::abs(r_start - r_end);
  const bool off_relative = difference / std::max(r_start, r_end) > tolerance.relative;
  if (difference > kSpiralFactor * tolerance.spiral ||
      (difference > tolerance.spiral && off_relative)) {
    return {
        centre,
        fmt::format("radius is {:.4f} mm at the start and {:.4f} mm at the end; they may "
                    "differ by {:.4f} mm or {} %",
                    r_start / mm, r_end / mm, tolerance.spiral / mm, 100.0 * tolerance.relative)};
  }
  return {centre, {}};
}

ArcCentre radius_format(const Eigen::Vector2d& start, const Eigen::Vector2d& end, double R,
                        bool clockwise, const ArcTolerance& tolerance) {
  if (start == end) return {start, "an arc with R cannot end where it starts; use I, J, K"};
  const Eigen::Vector2d chord = end - start;
  const double half = chord.norm() / 2.0;
  const double r = std::abs(R);
  if (half - r > tolerance.radius) {
    return {start, fmt::format("R {:.4f} mm is too small; half the chord is {:.4f} mm", r / mm,
                               half / mm)};
  }
  const bool semicircle = half / r > 1.0 - kSemicircleTol;
  const double height = semicircle ? 0.0 : std::sqrt((r - half) * (r + half));
  // the centre of a short clockwise arc lies to the right of its chord
  const double side = clockwise == (R > 0.0) ? 1.0 : -1.0;
  const Eigen::Vector2d right(chord.y(), -chord.x());
  return {start + chord / 2.0 + side * height / (2.0 * half) * right, {}};
}

}  // namespace servomill::controllers

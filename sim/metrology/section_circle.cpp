#include "sim/metrology/section_circle.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/metrology/circular_test.h"

namespace servomill::sim::metrology {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Far above the rounding of a program's coordinates, chords of a fine polygon included.
constexpr double kRound = 10.0 * um;

}  // namespace

std::vector<Vector2d> SectionCircle::in_plane(std::span<const Vector3d> points) const {
  std::vector<Vector2d> out;
  out.reserve(points.size());
  for (const Vector3d& p : points) out.emplace_back(p[first], p[second]);
  return out;
}

std::variant<SectionCircle, NoCircle> circle_of_section(std::span<const Vector3d> nominal) {
  if (nominal.size() < 3) return NoCircle{"has no feed motion"};
  Vector3d low = nominal.front(), high = nominal.front();
  for (const Vector3d& p : nominal) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  int normal = 2;
  if ((high - low).minCoeff(&normal) > kRound) return NoCircle{"is in none of XY, YZ, ZX"};

  SectionCircle circle;
  circle.first = (normal + 1) % 3;
  circle.second = (normal + 2) % 3;
  const std::vector<Vector2d> points = circle.in_plane(nominal);
  circle.nominal = least_squares_circle(points);
  const RingZone zone = zone_about(points, circle.nominal.centre);
  if (!(zone.width() <= 2.0 * kRound)) return NoCircle{"is not a circle"};  // a line: not a number
  if (const auto why = why_no_turn(points, circle.nominal)) return NoCircle{*why};
  return circle;
}

bool is_same_circle(const SectionCircle& one, const SectionCircle& other) {
  return one.first == other.first && (one.nominal.centre - other.nominal.centre).norm() <= kRound &&
         std::abs(one.nominal.radius - other.nominal.radius) <= kRound;
}

}  // namespace servomill::sim::metrology

#include "sim/metrology/circular_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/numerics/dense_solver.h"

namespace servomill::sim::metrology {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kNear = 0.1;  // of the radius: farther away it is another circle

// arcs about a reversal, in the direction of travel
// The friction peak behind a reversal, and what the loops make of it, are between the two arcs.
constexpr double kBeforeFrom = -15.0 * deg, kBeforeTo = -5.0 * deg;
constexpr double kBehindFrom = 30.0 * deg, kBehindTo = 40.0 * deg;

// The same angle within (-pi, pi].
double wrapped(double angle) { return std::remainder(angle, kTurn); }

double angle_of(const Vector2d& d) { return std::atan2(d.y(), d.x()); }

// How far the points go around the centre, counter-clockwise positive, and the longest step.
struct Travel {
  double turned = 0.0, longest = 0.0;
};

Travel travel_of(Points2 points, const Vector2d& centre) {
  Travel travel;
  if (points.empty()) return travel;
  double before = angle_of(points.front() - centre);
  for (const Vector2d& p : points.subspan(1)) {
    const double angle = angle_of(p - centre), step = wrapped(angle - before);
    travel.turned += step;
    travel.longest = std::max(travel.longest, std::abs(step));
    before = angle;
  }
  return travel;
}

// Two parallel lines, dr = level + slope phi + (step where phi > 0), through the arcs about a
// reversal.
struct ParallelLines {
  double level = 0.0, slope = 0.0, step = 0.0;
  double before(double phi) const { return level + slope * phi; }
  double behind(double phi) const { return before(phi) + step; }
};

ParallelLines lines_through(const std::vector<RadialError>& arcs) {  // theta: phi
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const auto& [phi, dr] : arcs) {
    const Vector3d row(1.0, phi, phi > 0.0 ? 1.0 : 0.0);
    // One slope for both sides: an ellipse has the same slope before and after the reversal, and is
    // not mistaken for a step.
    normal += row * row.transpose();
    right += row * dr;
  }
  const Vector3d x = numerics::solve_symmetric(normal, right);
  return {x[0], x[1], x[2]};
}

Reversal reversal_at(double theta, int axis, Sense sense, const std::vector<RadialError>& curve) {
  const double direction = sense == Sense::counter_clockwise ? 1.0 : -1.0;
  std::vector<RadialError> arcs, window;
  for (const RadialError& one : curve) {
    const double phi = wrapped(direction * (one.theta - theta));
    if ((phi >= kBeforeFrom && phi < kBeforeTo) || (phi > kBehindFrom && phi <= kBehindTo)) {
      arcs.push_back({phi, one.dr});
    } else if (phi >= kBeforeTo && phi <= kBehindFrom) {
      window.push_back({phi, one.dr});
    }
  }
  const ParallelLines lines = lines_through(arcs);
  Reversal reversal{theta, axis, 0.0, theta, lines.step};
  for (const auto& [phi, dr] : window) {
    const auto [low, high] = std::minmax({lines.before(phi), lines.behind(phi)});
    // Outside of the band between the two lines alone: within it the curve merely goes from one
    // level to the other.
    const double beyond = dr > high ? dr - high : dr < low ? dr - low : 0.0;
    if (std::abs(beyond) <= std::abs(reversal.spike)) continue;
    reversal.spike = beyond;
    reversal.spike_theta = theta + direction * phi;
  }
  return reversal;
}

}  // namespace

RadialRange radial_range(Points2 points, const Circle& circle) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  RadialRange range{-kInfinite, kInfinite};
  for (const Vector2d& p : points) {
    const double dr = (p - circle.centre).norm() - circle.radius;
    range.largest = std::max(range.largest, dr);
    range.smallest = std::min(range.smallest, dr);
  }
  return range;
}

RadialRange range_about_least_squares(Points2 points, const Circle& nominal) {
  return radial_range(points, {least_squares_circle(points).centre, nominal.radius});
}

std::vector<RadialError> radial_error(Points2 points, const Circle& circle) {
  std::vector<RadialError> curve;
  curve.reserve(points.size());
  for (const Vector2d& p : points) {
    const Vector2d d = p - circle.centre;
    const double theta = angle_of(d);
    curve.push_back({theta < 0.0 ? theta + kTurn : theta, d.norm() - circle.radius});
  }
  return curve;
}

double squareness_of(const std::vector<RadialError>& curve, double radius) {
  // by least squares together with the harmonics that a shift, a scale and an ellipse leave
  using Row = Eigen::Matrix<double, 5, 1>;
  Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
  Row right = Row::Zero();
  for (const auto& [theta, dr] : curve) {
    Row row;
    row << 1.0, std::cos(theta), std::sin(theta), std::cos(2.0 * theta), std::sin(2.0 * theta);
    normal += row * row.transpose();
    right += row * dr;
  }
  const Row x = numerics::solve_symmetric(normal, right);
  // A squareness error g makes dr = +-R g/2 sin(2 theta).
  return 2.0 * x[4] / radius;
}

std::optional<std::string> why_no_turn(Points2 points, const Circle& nominal, double spacing) {
  for (const Vector2d& p : points) {
    const double off = std::abs((p - nominal.centre).norm() - nominal.radius);
    if (off <= kNear * nominal.radius) continue;
    return fmt::format("deviates from the circle of radius {:.6g} mm by {:.4g} mm",
                       nominal.radius / mm, off / mm);
  }
  const Travel travel = travel_of(points, nominal.centre);
  if (travel.longest > spacing) {
    return fmt::format("has samples {:.3g} deg apart; must be <= {:g} deg", travel.longest / deg,
                       spacing / deg);
  }
  if (std::abs(std::abs(travel.turned) - kTurn) > spacing) {
    return fmt::format("covers {:.4g} deg of the circle; must be a full circle, 360 deg",
                       std::abs(travel.turned) / deg);
  }
  return std::nullopt;
}

Sense sense_of(Points2 points, const Circle& nominal) {
  return travel_of(points, nominal.centre).turned > 0.0 ? Sense::counter_clockwise
                                                        : Sense::clockwise;
}

CircularTurn evaluate_turn(Points2 points, const Circle& nominal) {
  CircularTurn turn{evaluate_about_least_squares(points, nominal), minimum_zone(points)};
  turn.G = turn.minimum_zone.width();
  return turn;
}

LeastSquaresTurn evaluate_about_least_squares(Points2 points, const Circle& nominal) {
  assert(!why_no_turn(points, nominal, kWidestSpacing));
  LeastSquaresTurn turn;
  turn.sense =
      travel_of(points, nominal.centre).turned > 0.0 ? Sense::counter_clockwise : Sense::clockwise;
  turn.least_squares = least_squares_circle(points);
  const Circle about{turn.least_squares.centre, nominal.radius};
  const RadialRange range = radial_range(points, about), set_up = radial_range(points, nominal);
  turn.F_max = range.largest;
  turn.F_min = range.smallest;
  turn.G_least_squares = range.width();
  turn.F_max_set_up = set_up.largest;
  turn.F_min_set_up = set_up.smallest;
  const auto curve = radial_error(points, about);
  for (std::size_t quadrant = 0; quadrant < 4; ++quadrant) {
    turn.reversals[quadrant] = reversal_at(static_cast<double>(quadrant) * kTurn / 4.0,
                                           static_cast<int>(quadrant % 2), turn.sense, curve);
  }
  turn.squareness = squareness_of(curve, nominal.radius);
  return turn;
}

BidirectionalCircle evaluate_both(Points2 one, Points2 other, const Circle& nominal) {
  std::vector<Vector2d> both(one.begin(), one.end());
  both.insert(both.end(), other.begin(), other.end());
  const Circle least_squares = least_squares_circle(both);
  BidirectionalCircle out;
  out.G_b = minimum_zone(both).width();
  out.G_b_least_squares = zone_about(both, least_squares.centre).width();
  out.D = nominal.radius - least_squares.radius;
  for (const Points2 points : {one, other}) {
    const Circle mine{least_squares_circle(points).centre, nominal.radius};
    out.squareness += 0.5 * squareness_of(radial_error(points, mine), nominal.radius);
  }
  return out;
}

}  // namespace servomill::sim::metrology

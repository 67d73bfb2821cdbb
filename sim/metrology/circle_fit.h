/// Circles through measured points: least squares and minimum zone.
#pragma once

#include <Eigen/Core>

#include "sim/metrology/points.h"

namespace servomill::sim::metrology {

struct Circle {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius = 0.0;
};

/// Two concentric circles that enclose points.
struct RingZone {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double inner = 0.0, outer = 0.0;  // radii
  double width() const { return outer - inner; }
};

/// The circle with the smallest sum of (|p - centre| - radius)^2: distances, not the algebraic
/// |p|^2 + a x + b y + c, whose circle (I. Kasa, 1976) is only where Gauss-Newton begins. The two
/// agree to second order of the deviations, and exactly for points on a circle.
/// @pre at least three points that lie on no line
Circle least_squares_circle(Points2 points);

/// The smallest pair of circles about a given centre.
/// @pre there are points
RingZone zone_about(Points2 points, const Eigen::Vector2d& centre);

/// The pair of concentric circles with the smallest radial separation (minimum zone) that encloses
/// the points. For small shifts of the centre the distances are linear, and the best shift is a
/// linear program in four variables; it is solved for the points that matter, again from the new
/// centre with the points that then stick out, until none does.
/// @pre at least three points around the circle: no gap of half a turn or more, and deviations that
///      are small against the radius; else a zone of smaller width may exist far away
RingZone minimum_zone(Points2 points);

}  // namespace servomill::sim::metrology

/// Circular test after ISO 230-4, evaluated as from a ball bar or a grid encoder: one turn of the
/// tool centre point about a nominal circle, or two turns in opposite directions.
///
///                y                  All lengths in m, all angles in rad. The angle theta counts
///                | 90 deg           from the first axis of the plane towards the second. Radial
///           .--"""--.               deviations are positive away from the centre.
///         .'     |    '.
///        /       |  theta\          Evaluated is one whole turn at speed: cut away where the
///       |        +--------| x       path begins and ends (ISO 230-4 does so with the arc on
///        \              0 /         which feed is reached).
///         '.           .'
///           '--.___.--'
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/metrology/circle_fit.h"

namespace servomill::sim::metrology {

enum class Sense { counter_clockwise, clockwise };

/// One point of the curve that a polar diagram magnifies.
struct RadialError {
  double theta = 0.0;  // about the centre, [0, 2 pi)
  double dr = 0.0;
};

/// Reversal of an axis of the plane, and the deviation there.
///
/// The curve before and behind is taken as two parallel lines, by least squares over the arcs from
/// 15 to 5 deg before the reversal and from 30 to 40 deg behind it, in the direction of travel. The
/// step from one to the other is what backlash leaves. The spike (quadrant glitch) is the largest
/// excursion beyond both lines, from 5 deg before the reversal to 30 deg behind it: a step alone is
/// no spike. Of ellipses, which have neither, the lines leave 0.06 a of a sin 2 theta (squareness)
/// and 0.22 a of a cos 2 theta (scales that differ).
struct Reversal {
  double theta = 0.0;        // nominal place: 0, 90, 180 or 270 deg
  int axis = 0;              // which reverses there: 0 the first of the plane, 1 the second
  double spike = 0.0;        // outward positive
  double spike_theta = 0.0;  // where it is largest
  double step = 0.0;         // of the line, behind minus before
};

/// One turn about its least-squares circle.
struct LeastSquaresTurn {
  Sense sense = Sense::counter_clockwise;
  Circle least_squares;
  double G_least_squares = 0.0;     // range of the radial deviation about the least-squares centre
  double F_max = 0.0, F_min = 0.0;  // radial deviation from the nominal radius, about that centre
  double F_max_set_up = 0.0, F_min_set_up = 0.0;  // the same about the nominal centre
  std::array<Reversal, 4> reversals;              // at 0, 90, 180, 270 deg
  double squareness = 0.0;                        // rad; (D45 - D135) / (2 R), see squareness_of
};

/// One turn.
struct CircularTurn : LeastSquaresTurn {
  RingZone minimum_zone;
  double G = 0.0;  // circular error: width of the minimum zone
};

/// Two turns about one nominal circle.
struct BidirectionalCircle {
  double G_b = 0.0;                // width of the minimum zone of both paths together
  double G_b_least_squares = 0.0;  // range of the radial deviation about their common centre
  /// Mean bi-directional radial deviation: nominal radius minus radius of the least-squares circle
  /// through both paths, hence positive where the circle became too small.
  double D = 0.0;
  double squareness = 0.0;  // rad; mean of both directions, free of what follows the direction
};

/// Largest and smallest radial deviation of some points from a circle.
struct RadialRange {
  double largest = 0.0, smallest = 0.0;
  double width() const { return largest - smallest; }
};
RadialRange radial_range(Points2 points, const Circle& circle);
/// About the least-squares centre, from the nominal radius: LeastSquaresTurn::F_max and F_min.
RadialRange range_about_least_squares(Points2 points, const Circle& nominal);

/// Deviation from a circle over the angle, in the order of the points.
std::vector<RadialError> radial_error(Points2 points, const Circle& circle);

/// gamma = (D45 - D135) / (2 R), rad: the diameters at 45 and at 135 deg are those of the second
/// harmonic of the radial deviation, a sin 2 theta, so that D45 - D135 = 4 a and gamma = 2 a / R.
/// gamma > 0: the angle between the positive axes is smaller than 90 deg by gamma. Axes that lag by
/// different times give the same ellipse, the other way round in the other direction.
double squareness_of(const std::vector<RadialError>& curve, double radius);

/// Distance of neighbouring points of a turn: of recorded ones, and of readings, whose number is
/// that of the instrument. Beyond the latter, the arcs about a reversal hold no line.
inline constexpr double kRecordedSpacing = 2.0 * deg, kWidestSpacing = 5.001 * deg;

/// Why these points are no turn that can be evaluated; nullopt if they are. They must go once
/// around the centre (360 deg to within `spacing`, at which the points of a turn may lie apart) and
/// stay near the circle.
std::optional<std::string> why_no_turn(Points2 points, const Circle& nominal,
                                       double spacing = kRecordedSpacing);

/// @pre why_no_turn(points, nominal, kWidestSpacing) is nullopt
Sense sense_of(Points2 points, const Circle& nominal);

/// All of a turn but its minimum zone, which takes the longest to find.
/// @pre why_no_turn(points, nominal, kWidestSpacing) is nullopt
LeastSquaresTurn evaluate_about_least_squares(Points2 points, const Circle& nominal);
/// @pre why_no_turn(points, nominal, kWidestSpacing) is nullopt
CircularTurn evaluate_turn(Points2 points, const Circle& nominal);

/// @pre two turns, one in each direction
BidirectionalCircle evaluate_both(Points2 one, Points2 other, const Circle& nominal);

}  // namespace servomill::sim::metrology

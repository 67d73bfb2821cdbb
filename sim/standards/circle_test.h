/// Circular tests after ISO 230-4 from a ball bar or a grid encoder.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "sim/metrology/circular_test.h"
#include "sim/readings/readings.h"
#include "sim/standards/report.h"

namespace servomill::sim::standards {

/// Points of one turn, in the order in which they were passed.
struct CirclePath {
  metrology::Sense sense = metrology::Sense::counter_clockwise;
  std::vector<Eigen::Vector2d> points;  // m, about the centre of the set-up
  std::vector<Place> places = {};       // of their rows; none: of a simulated test
};

struct CircleTest {
  std::string name;
  double radius = 0.0;            // m, nominal
  std::vector<CirclePath> turns;  // one, or one in each direction
};

/// Reads turns from a table: `direction` (ccw, cw) and either `angle_deg` and `deviation_um` of the
/// radius (ball bar) or `x_mm` and `y_mm` (grid encoder) about the centre of the set-up.
/// @param radius  m, nominal
/// @throws InputError with all faults: a direction there twice, an arc in place of a turn, ...
CircleTest read_circle(const std::string& path, double radius);

/// A group of kind circle, one test a run. @throws InputError
std::vector<CircleTest> circles_of(const readings::Group& group, const JointLayout& layout);

/// Errors of the axes of the plane that a circle shows, by least squares over all turns:
/// dr = r_0 + c cos + s sin + R mismatch / 2 cos 2 theta + R squareness / 2 sin 2 theta
///      + B_1 / 2 sgn(v_1) cos + B_2 / 2 sgn(v_2) sin, v the travel of each axis.
struct CircleFit {
  double squareness = 0.0;       // rad; positive: angle between the positive axes below 90 deg
  double scale_mismatch = 0.0;   // scale of the first axis minus that of the second
  std::array<double, 2> B = {};  // m, reversal as in ISO 230-2: upwards minus downwards
};
CircleFit fit_circle(const CircleTest& test);

Report circle_report(const CircleTest& test);

}  // namespace servomill::sim::standards

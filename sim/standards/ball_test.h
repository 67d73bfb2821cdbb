/// Tests with a ball and a nest of sensors after ISO 10791-6 (AK, BK, CK): the range of what each
/// sensor shows while axes move and the ball is to stand.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "sim/readings/readings.h"
#include "sim/standards/report.h"

namespace servomill::sim::standards {

/// Displacement of the ball over a test, one path a direction of motion.
struct BallTest {
  std::string name;
  std::vector<std::string> sensors;  // "radial", "tangential", "axial"; "x", "y", "z"
  struct Path {
    int direction = 0;                        // 1, -1; 0: not known
    std::vector<std::vector<double>> values;  // m; of each sensor
    std::vector<double> angles = {};          // rad, of the rotary axis at each; none: not known
  };
  std::vector<Path> paths;
};

/// Reads a table: `direction` (forward, backward; ccw, cw), an angle (`angle_deg`, `A_deg`, `B_deg`
/// or `C_deg`), over which figures are drawn, and sensors: `radial_um`, `tangential_um`,
/// `axial_um`, `bar_um`, or `dx_um`, `dy_um`, `dz_um`. @throws InputError with all faults
BallTest read_ball(const std::string& path);

/// A group of kind r_test.
BallTest ball_of(const readings::Group& group);

/// Range of each sensor: of each direction and of both together; a table of each path.
Report ball_report(const BallTest& test);

}  // namespace servomill::sim::standards

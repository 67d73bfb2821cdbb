/// Tests of a machine that a run makes: its program moves the axes, a simulated device reads them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"
#include "sim/standards/positioning_uncertainty.h"
#include "sim/standards/test_cycle.h"

namespace servomill::sim::model {

/// Standards by which a run can test: positioning of an axis, diagonals, circles, error motion of a
/// rotary table, a rotary axis about a ball.
enum class TestStandard : std::uint8_t { positioning, diagonals, circles, error_motion, ball };
inline constexpr std::array<std::string_view, 5> kTestStandards = {
    "iso230-2", "iso230-6", "iso230-4", "iso230-7", "iso10791-6"};

/// Line along which targets are approached; of a rotary axis its positions.
struct TestLine {
  std::string name;                         // of a diagonal: "PPP", "NPP", ...
  AxisWords from = AxisWords::Zero();       // m, rad, at 0 of the targets
  AxisWords direction = AxisWords::Zero();  // unit vector
};

/// In work coordinates.
struct MachineTest {
  std::string name;  // and of the section of the program
  TestStandard standard = TestStandard::positioning;
  std::vector<Axis> axes;       // that move: linear axes, or one rotary axis
  std::vector<TestLine> lines;  // of positioning and diagonals
  standards::TestCycle cycle;   // along each line; its overrun also where no targets are
  AxisWords at =
      AxisWords::Zero();          // m, rad; where the other axes are; centre of circles; the ball
  double radius = 0.0;            // m; of circles in the plane of both axes
  double begin = 0.0, end = 0.0;  // rad; positions of a rotary axis between which it is read
  int revolutions = 0;            // from begin to end, of error_motion
  double distance = 0.0;          // m, along the axis to a second ball; 0: there is none
  int readings = 0;               // of each circle, revolution or direction
  double feed = 0.0;              // m/s, of a rotary axis rad/s
  double dwell = 0.0;             // s, at every stop that is measured
  int tool = 0;                   // T; its TCP is the measured point; 0: the spindle nose
  standards::PositioningContributions device;
  std::uint64_t seed = 1;  // of the errors of the device
  Place place;

  bool has_lines() const {
    return standard == TestStandard::positioning || standard == TestStandard::diagonals;
  }
  bool is_rotary() const { return axes.size() == 1 && !is_linear(axes.front()); }
  /// True if the device sees how the tool is turned about its axis.
  bool needs_orientation() const { return is_rotary() && standard != TestStandard::ball; }
  double reading_spacing() const;  ///< rad, of circles and turns
  /// False where its keys have faults.
  bool moves() const;
};

using MachineTests = std::vector<std::shared_ptr<const MachineTest>>;

/// A place where the axes stop. It is measured unless they reverse there.
struct TestStop {
  AxisWords position = AxisWords::Zero();  // m, rad
  std::size_t line = 0;
  standards::CycleStop on_line;
  bool is_measured() const { return on_line.direction != 0; }
};

/// All stops in their order. Of circles: the centre; the begin of the counter-clockwise arc; its
/// end, where the clockwise one begins; the end of that. Of a rotary axis that is read in motion:
/// one overrun before `begin`, one after `end` and, of a ball, the first again.
std::vector<TestStop> stops(const MachineTest& test);

/// Circles begin and end with an arc that is not measured, on which the axes accelerate.
inline constexpr double kFeedIn = 0.78539816339744831;  // rad, 45 deg

/// Diagonals of a box between two opposite corners, four, or of a face, two: from the corner that
/// their name gives, P where the axis travels upwards, N where it travels downwards.
/// @param axes  three, or the two of the face; the other axes are where `from` has them
std::vector<TestLine> diagonals(const AxisWords& from, const AxisWords& to,
                                const std::vector<Axis>& axes);

/// Program of all tests, one section each.
std::string program_of(const MachineTests& tests, const JointLayout& layout);

}  // namespace servomill::sim::model

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

/// Standards by which a run can test: positioning of a linear axis, diagonals, circles.
enum class TestStandard : std::uint8_t { positioning, diagonals, circles };
inline constexpr std::array<std::string_view, 3> kTestStandards = {"iso230-2", "iso230-6",
                                                                   "iso230-4"};

/// Line along which targets are approached.
struct TestLine {
  std::string name;                                      // of a diagonal: "PPP", "NPP", ...
  Eigen::Vector3d from = Eigen::Vector3d::Zero();        // m, X Y Z at 0 of the targets
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // unit vector
};

/// In work coordinates.
struct MachineTest {
  std::string name;  // and of the section of the program
  TestStandard standard = TestStandard::positioning;
  std::vector<Axis> axes;            // linear axes that move
  std::vector<TestLine> lines;       // none for circles
  standards::TestCycle cycle;        // along each line
  AxisWords at = AxisWords::Zero();  // m, rad; where the other axes are; centre of circles
  double radius = 0.0;               // m; of circles in the plane of both axes
  int readings = 0;                  // of each circle
  double feed = 0.0;                 // m/s
  double dwell = 0.0;                // s, at every stop that is measured
  int tool = 0;                      // T; its TCP is the measured point; 0: the spindle nose
  standards::PositioningContributions device;
  std::uint64_t seed = 1;  // of the errors of the device
  Place place;

  /// False where its keys have faults.
  bool moves() const {
    return standard == TestStandard::circles ? axes.size() == 2
                                             : !lines.empty() && !cycle.targets.empty();
  }
};

using MachineTests = std::vector<std::shared_ptr<const MachineTest>>;

/// A place where the axes stop. It is measured unless they reverse there.
struct TestStop {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m, X Y Z
  std::size_t line = 0;
  standards::CycleStop on_line;
  bool is_measured() const { return on_line.direction != 0; }
};

/// All stops in their order. Of circles: the centre; the begin of the counter-clockwise arc; its
/// end, where the clockwise one begins; the end of that.
std::vector<TestStop> stops(const MachineTest& test);

/// Circles begin and end with an arc that is not measured, on which the axes accelerate.
inline constexpr double kFeedIn = 0.78539816339744831;  // rad, 45 deg

/// Diagonals of a box between two opposite corners, four, or of a face, two: from the corner that
/// their name gives, P where the axis travels upwards, N where it travels downwards.
/// @param axes  three, or the two of the face; of the other axis `from` is used
std::vector<TestLine> diagonals(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                                const std::vector<Axis>& axes);

/// Program of all tests, one section each.
std::string program_of(const MachineTests& tests, const JointLayout& layout);

}  // namespace servomill::sim::model

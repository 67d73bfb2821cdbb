// A scenario whose program controls the tool centre point.
#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "plant/vocabulary/units.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::tool_centre_point_test {
namespace {

constexpr double kStraight = 0.5;    // um: chords of the planner at a tolerance of 10 um
constexpr double kTolerance = 10.0;  // um, of the machine
constexpr double kRecorded = 1e-9;   // mm, rounding of machine coordinates of some 100 mm

const char* const kTip =
    "G21 G90 G94 G43.4 H1\nG0 X-40 Y10 Z20 B10 C0\n(MSG, line)\nG1 X40 Y20 Z30 B40 C60 F1500\n"
    "(MSG, turn)\nC90\nM2\n";
const std::string kTool = "[[program.tool]]\nnumber = 1\nlength_mm = 100.0\n";
const std::string kCases = "[[case]]\nname = \"ideal\"\nservo = \"ideal\"\n" + kTool;
const Eigen::Vector3d kFrom(-40, 10, 20), kTo(40, 20, 30);  // mm

Eigen::Vector3d point(const records::Series& series, const std::string& name, std::size_t row) {
  return {series.at(row, *series.column(name, 'X')), series.at(row, *series.column(name, 'Y')),
          series.at(row, *series.column(name, 'Z'))};
}

double off_line(const Eigen::Vector3d& p) {
  return (p - kFrom).cross((kTo - kFrom).normalized()).norm();
}

TEST(ToolCentrePoint, IsNominallyOnTheStraightLineAtEqualS) {
  const CaseOutput output = run_named_case(small_scenario(kTip, kCases), "ideal");
  const records::Series& series = output.result.servo;
  const std::size_t line = *series.column("line");
  double furthest = 0.0;
  for (std::size_t n = 0; n < series.rows(); ++n) {
    if (series.at(n, line) != 4.0) continue;
    const Eigen::Vector3d nominal = point(series, "tool_position_nominal", n);
    EXPECT_LT(off_line(nominal), kRecorded);
    furthest = std::max(furthest, (nominal - kFrom).norm());
    EXPECT_LT(off_line(point(series, "tool_position_true", n)), kStraight * um / mm);
    EXPECT_LT(series.at(n, *series.column("contour_error")), kStraight);
    // the end is a corner in the joints: C turns on while the tip stands
    const bool is_at_end = (nominal - kTo).norm() < 1.0;
    EXPECT_LT(point(series, "tool_deviation", n).norm(), is_at_end ? kTolerance : 2 * kStraight);
  }
  EXPECT_NEAR(furthest, (kTo - kFrom).norm(), 0.01);
  // the tip stands while C turns
  const std::size_t last = series.rows() - 1;
  EXPECT_LT((point(series, "tool_position_true", last) - kTo).norm(), 1e-6);
  EXPECT_NEAR(series.at(last, *series.column("ref_rotary", 'C')), 90.0, 1e-9);
  EXPECT_TRUE(output.notes.empty());
}

TEST(ToolCentrePoint, FollowsThroughTheServoLoops) {
  const CaseOutput output =
      run_named_case(small_scenario(kTip, "[[case]]\nname = \"servo\"\n" + kTool), "servo");
  const records::Series& series = output.result.servo;
  double worst = 0.0;
  for (std::size_t n = 0; n < series.rows(); ++n) {
    if (series.at(n, *series.column("line")) != 4.0) continue;
    worst = std::max(worst, series.at(n, *series.column("contour_error")));
  }
  EXPECT_GT(worst, 0.0);
  EXPECT_LT(worst, 20.0) << "um; the loops lag, the tip does not leave by millimetres";
}

TEST(ToolCentrePoint, TellsWhatTheNcPutRightAndWhereItSlowedDown) {
  const CaseOutput output = run_named_case(
      small_scenario("G21 G43.5 H1\nG0 X-40 Z20 I-0.3 J0.01 K1\nG1 X40 I0.3 J0.01 K1 F4000\nM2\n",
                     kCases),
      "ideal");
  ASSERT_EQ(output.notes.size(), 3U);
  EXPECT_NE(output.notes[0].find("small.ngc:2:13: warning: the tool axis I J K has length 1.04408; "
                                 "normalised to a unit vector"),
            std::string::npos)
      << output.notes[0];
  EXPECT_NE(
      output.notes[2].find("small.ngc:3: warning: the programmed feed rate requires C at 1.31e+07 "
                           "deg/s^3, 0.57 deg from a singular direction of the tool axis; its "
                           "limit is 1.146e+05: the feed rate is reduced to about 20.6 %"),
      std::string::npos)
      << output.notes[2];
}

std::string fault_of(const std::string& program, const std::string& toml) {
  try {
    check_scenario(small_scenario(program, toml));
    return "";
  } catch (const InputError& error) {
    return error.faults().front().message;
  }
}

TEST(ToolCentrePoint, IsNotStraightened) {
  EXPECT_EQ(fault_of(kTip, "[[case]]\nname = \"g\"\n[[case.strategy]]\ntype = \"exact\"\n" + kTool),
            "case g: strategy exact: cannot rewrite moves under TCP control or in a tilted work "
            "plane (small.ngc:2)");
}

TEST(ToolCentrePoint, SaysWhereTheTravelEnds) {
  EXPECT_EQ(fault_of("G43.4 H1\nG0 X-40 Y10 Z20\nG1 Z-450 B60 F1000\nM2\n", kCases),
            "Z moves to -169.9960 mm, outside its travel; must be >= -100.0000");
  EXPECT_EQ(fault_of("G43.5 H1\nG0 X0 Z20 I-1 J0 K-1\nM2\n", kCases),
            "the tool axis (-0.707107, 0.000000, -0.707107) requires B = -135.0000 deg; must be >= "
            "-121.0000");
}

}  // namespace
}  // namespace servomill::sim::run::tool_centre_point_test

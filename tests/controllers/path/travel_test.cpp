#include "controllers/path/travel.h"

#include <gtest/gtest.h>

#include <limits>

#include "programs.h"

namespace servomill::controllers::test::travel_test {
namespace {

std::vector<std::string> faults(const Program& program) {
  Joints lower, upper;
  const double endless = std::numeric_limits<double>::infinity();
  lower << -400 * mm, -300 * mm, -500 * mm, -121 * deg, -endless;
  upper << 400 * mm, 300 * mm, 0.0, 91 * deg, endless;
  std::vector<std::string> out;
  for (const Fault& fault :
       travel_faults(program.moves(), kLayout, program.start(), lower, upper, "part.nc")) {
    out.push_back(to_string(fault));
  }
  return out;
}

using Lines = std::vector<std::string>;

TEST(Travel, IncludesItsBounds) {
  EXPECT_EQ(faults(Program().line(0.4, -0.3, -0.5, 0.1)), Lines{});
}

TEST(Travel, NamesLineAxisValueAndLimit) {
  Program program;
  program.line(0.1, 0, 0, 0.1).line(0.4005, 0, 0.001, 0.1);
  EXPECT_EQ(
      faults(program),
      (Lines{"part.nc:2: error: X moves to 400.5000 mm, outside its travel; must be <= 400.0000",
             "part.nc:2: error: Z moves to 1.0000 mm, outside its travel; must be <= 0.0000"}));
}

TEST(Travel, CountsWhatComesBehindAThousandFaults) {
  Program program;
  for (int n = 0; n < 1500; ++n) program.line(0.41, 0.1 * mm * n, 0.0, 0.1);
  const Lines all = faults(program);
  ASSERT_EQ(all.size(), 1001U);
  EXPECT_EQ(all[999],
            "part.nc:1000: error: X moves to 410.0000 mm, outside its travel; must be <= 400.0000");
  EXPECT_EQ(all[1000], "part.nc:1500: error: the last of 500 more motions outside the travel");
}

TEST(Travel, CountsRotaryAxesInDegreesAndLeavesEndlessOnesFree) {
  AxisWords to = AxisWords::Zero();
  to[4] = -122 * deg;
  to[5] = 1000 * deg;
  EXPECT_EQ(
      faults(Program().line(to, 1.0)),
      (Lines{
          "part.nc:1: error: B moves to -122.0000 deg, outside its travel; must be >= -121.0000"}));
}

TEST(Travel, SeesTheExtremePointOfAnArc) {
  Joints start = Joints::Zero();
  start.head<3>() << 0.39, -0.02, 0.0;
  const Eigen::Vector3d centre(0.39, 0, 0), to(0.39, 0.02, 0);
  EXPECT_EQ(
      faults(Program(start).arc(centre, to, 2, 1, 0.1)),
      (Lines{"part.nc:1: error: X moves to 410.0000 mm, outside its travel; must be <= 400.0000"}));
  EXPECT_EQ(faults(Program(start).arc(centre, to, 2, -1, 0.1)), Lines{});
}

TEST(Travel, SeesTheFarthestPointOfASpline) {
  Joints start = Joints::Zero();
  start.head<3>() << 0.39, -0.02, 0.0;
  // an arch of the height 3/4 of that of its control points
  EXPECT_EQ(
      faults(Program(start).spline(4, {{0.41, -0.02}, {0.41, 0.02}, {0.39, 0.02}}, 0.1)),
      (Lines{"part.nc:1: error: X moves to 405.0000 mm, outside its travel; must be <= 400.0000"}));
  EXPECT_EQ(faults(Program(start).spline(4, {{0.4, -0.02}, {0.4, 0.02}, {0.39, 0.02}}, 0.1)),
            Lines{});
}

}  // namespace
}  // namespace servomill::controllers::test::travel_test

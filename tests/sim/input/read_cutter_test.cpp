/// The cutting part of tools in scenarios.
#include "sim/input/read_cutter.h"

#include <gtest/gtest.h>

#include <numbers>
#include <string>

#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"
#include "tests/text.h"

namespace servomill::sim::input::read_cutter_test {
namespace {

model::Scenario with_tool(const std::string& keys) {
  return small_scenario("G1 X1 F100\nM30\n", "[[program.tool]]\nnumber = 3\nlength_mm = 100.0\n" +
                                                 keys + "[[case]]\nname = \"one\"\n");
}

std::string faults_of(const std::string& keys) {
  return fault_messages([&] { with_tool(keys); });
}

constexpr double kRounding = 1e-15;

TEST(CutterOfATool, HasTheValuesGiven) {
  const auto scenario = with_tool(
      "diameter_mm = 8.0\ncorner_radius_mm = 1.5\nflute_length_mm = 19.0\nteeth = 4\n"
      "helix_deg = 45.0\n");
  const plant::Cutter& cutter = scenario.program.cutters.at(3);
  EXPECT_NEAR(cutter.radius, 4e-3, kRounding);
  EXPECT_NEAR(cutter.corner_radius, 1.5e-3, kRounding);
  EXPECT_NEAR(cutter.length, 19e-3, kRounding);
  EXPECT_EQ(cutter.teeth, 4);
  EXPECT_NEAR(cutter.helix, std::numbers::pi / 4.0, kRounding);
}

TEST(CutterOfATool, IsAFlatEndMillOfFourDiametersIfNothingIsSaid) {
  const plant::Cutter cutter = with_tool("diameter_mm = 8.0\n").program.cutters.at(3);
  EXPECT_TRUE(cutter.is_flat());
  EXPECT_NEAR(cutter.length, 32e-3, kRounding);
  EXPECT_EQ(cutter.teeth, 2);
}

TEST(CutterOfATool, IsMissingWithoutADiameter) {
  EXPECT_TRUE(with_tool("").program.cutters.empty());
  EXPECT_EQ(faults_of("teeth = 4\n"), "program.tool[0].teeth = 4; needs a diameter_mm above 0\n");
}

TEST(CutterOfATool, MayHaveACornerRadiusUpToThatOfABall) {
  EXPECT_TRUE(
      with_tool("diameter_mm = 8.0\ncorner_radius_mm = 4.0\n").program.cutters.at(3).is_ball());
  EXPECT_NE(faults_of("diameter_mm = 8.0\ncorner_radius_mm = 4.001\n"), "");
}

}  // namespace
}  // namespace servomill::sim::input::read_cutter_test

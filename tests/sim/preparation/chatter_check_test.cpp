#include "sim/preparation/chatter_check.h"

#include <gtest/gtest.h>

#include <numbers>

#include "plant/cutting/stability_lobes.h"
#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"
#include "sim/model/scenario.h"
#include "sim/preparation/preparation_cache.h"
#include "tests/sim/cutting_block.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::preparation::chatter_check_test {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kTurns = 80.0;

const plant::CuttingCoefficients& steel() { return plant::find_material("42CrMo4")->typical; }
const std::vector<plant::StructuralMode> kNormal = {
    {.direction = Vector3d::UnitY(), .compliance = 1.0 / 20e6, .mode = {2.0 * kPi * 500.0, 0.03}}};

double slot_limit() {
  const plant::ChatterMode mode{.stiffness = 20e6, .frequency = 2.0 * kPi * 500.0, .damping = 0.03};
  return plant::zeroth_order_limit({.coefficients = steel(), .teeth = 4, .from = 0.0, .to = kPi},
                                   {&mode, 1}, kTurns)
      .depth;
}

std::vector<Fault> warnings_of(double share, int lines = 1,
                               const std::vector<plant::StructuralMode>& modes = kNormal) {
  const plant::MachineChain chain = plant::make_chain(plant::parse_structure("[w b X Y Z t]"));
  ChatterCheck check(modes, steel(), chain);
  const plant::Cutter cutter{.radius = 5 * mm, .length = 50 * mm, .teeth = 4};
  const double depth = share * slot_limit();
  const plant::EngagedArc arc{.width = depth, .height = 0.5 * depth, .from = 0.0, .to = kPi};
  for (int line = 1; line <= lines; ++line) {
    check.add(line, 2, cutter, {Eigen::Matrix3d::Identity(), {}}, {&arc, 1}, kTurns,
              Joints::Zero());
  }
  return check.warnings("part.nc");
}

TEST(ChatterCheck, reports_cuts_beyond_the_limit_with_their_ratio) {
  EXPECT_TRUE(warnings_of(0.99).empty());
  const auto beyond = warnings_of(1.3);
  ASSERT_EQ(beyond.size(), 1U);
  EXPECT_EQ(beyond[0].place.file, "part.nc");
  EXPECT_EQ(beyond[0].place.line, 1);
  EXPECT_EQ(beyond[0].message.substr(0, 77),
            "tool 2 at 4800 1/min cuts 1.30 times as deep as its limit of stability: it ch");
}

TEST(ChatterCheck, names_five_lines_and_counts_the_others) {
  const auto all = warnings_of(1.3, 8);
  ASSERT_EQ(all.size(), 6U);
  EXPECT_EQ(all[5].message, "3 more lines with cuts that chatter");
}

TEST(ChatterCheck, without_modes_across_the_tool_has_nothing_to_report) {
  EXPECT_TRUE(warnings_of(5.0, 1, {}).empty());
  std::vector<plant::StructuralMode> along = kNormal;
  along[0].direction = Vector3d::UnitZ();
  EXPECT_TRUE(warnings_of(5.0, 1, along).empty());
}

std::string mode_along(const std::string& direction) {
  return "[machine_override]\nstructural_mode = [{ direction = [" + direction +
         "], stiffness = \"20 N/um\", frequency_Hz = 500.0, damping = 0.03 }]\n";
}

// 4800 1/min, 2 mm deep in steel.
TEST(ChatterCheck, of_a_run_is_among_its_warnings) {
  const std::string program =
      "G17 G90 T1 M6\nG43 H1\nS4800 M3\nG0 X-30 Y0\nZ-2\nG1 X30 F1394\nM30\n";
  const model::Scenario scenario =
      small_scenario(program, kTool + kBlock + kSteel + one_case("cut") + mode_along("0, 1, 0"));
  const PreparedCase prepared(scenario, scenario.cases.front());
  const auto& warnings = prepared.parts().cutting->warnings;
  ASSERT_EQ(warnings.size(), 1U);
  EXPECT_EQ(warnings[0].place.line, 6);
  EXPECT_NE(warnings[0].message.find("times as deep as its limit of stability"), std::string::npos);
}

std::string refusal(const std::string& toml) {
  try {
    const model::Scenario scenario = small_scenario(kSlot, toml);
    PreparedCase(scenario, scenario.cases.front());
  } catch (const InputError& error) {
    const std::string text = error.what();
    return text.substr(text.find("error: ") + 7);
  }
  return "";
}

TEST(ChatterCheck, regeneration_needs_teeth_and_modes_across_the_tool) {
  const std::string teeth = kSteel + "force = \"instantaneous\"\nregeneration = true\n";
  const std::string common = kTool + kBlock;
  EXPECT_EQ(refusal(common + kSteel + "regeneration = true\n" + one_case("cut")),
            "cutting.regeneration = true; needs force = \"instantaneous\"");
  EXPECT_EQ(refusal(common + teeth + "depth_of_cut = \"actual\"\n" + one_case("cut")),
            "cutting.regeneration = true; needs depth_of_cut = \"nominal\": the chip thickness "
            "follows the vibration");
  const std::string needs =
      "case cut: regeneration = true needs a tool point that is compliant across the tool axis "
      "([[structural_mode]] or structural_stiffness of the machine); ";
  EXPECT_EQ(refusal(common + teeth + one_case("cut")), needs + "it is rigid");
  EXPECT_EQ(refusal(common + teeth + one_case("cut") + mode_along("0, 0, 1")),
            needs + "all of its modes are along the tool");
  const auto static_along = [](const std::string& direction) {
    return "[machine_override]\nstructural_mode = [{ direction = [" + direction +
           "], stiffness = \"20 N/um\" }]\n";
  };
  EXPECT_EQ(refusal(common + teeth + one_case("cut") + static_along("0, 0, 1")),
            needs + "it is compliant along the tool axis only");
  EXPECT_EQ(refusal(common + teeth + one_case("cut") + static_along("0, 1, 0")), "");
}

}  // namespace
}  // namespace servomill::sim::preparation::chatter_check_test

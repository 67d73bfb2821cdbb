/// Cuts whose depth follows errors and deflections of the machine.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/cutting/cutting_force.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/depth_of_cut.h"
#include "sim/model/scenario.h"
#include "tests/sim/cutting_block.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::engine::actual_depth_run_test {
namespace {

using Eigen::Vector3d;

const double kChip = 1394.0 / (4775.0 * 4) * mm;  // feed per tooth
constexpr double kDeep = 2 * mm, kWide = 0.2 * mm;

// A wall on the left of the feed, 0.2 mm of it cut in up milling.
const std::string kWall =
    "G17 G90 T1 M6\nG43 H1\nS4775 M3\nG0 X-30 Y-23.8\nZ-2\nG1 X30 F1394\nM30\n";

// Average force of so much of the wall (N, in W).
Vector3d wall_force(double width, double deep = kDeep) {
  const double exit = std::acos(1.0 - width / (4 * mm));
  const plant::EngagedArc arc{.width = deep, .height = 0.5 * deep, .from = 0.0, .to = exit};
  return plant::average_force(plant::find_material("42CrMo4")->typical, 4, {}, {&arc, 1}).at(kChip);
}

Vector3d mean_force(const std::string& more, const std::string& cutting,
                    const std::string& keys = "") {
  const run::CaseOutput out = run_named_case(
      small_scenario(kWall, keys + kTool + kBlock + kSteel + cutting + more + one_case("cut")),
      "cut");
  Vector3d F;
  for (int i = 0; i < 3; ++i) {
    F[i] = mean_of(out.result.servo, "cutting_force", "XYZ"[i],
                   rows_within(out.result.servo, -5.0, 10.0));
  }
  return F;
}

const std::string kActual = "depth_of_cut = \"actual\"\n", kErrors = "machine_errors = \"off\"\n";
std::string off(double um) {
  return fmt::format("[errors.off]\nEYY = {{ constant_um = {} }}\n", um);
}
// of the profile that is searched, the speed, and what a servo loop leaves
constexpr double kShare = 5e-3;

TEST(ActualDepth, follows_an_error_across_the_feed) {
  for (const double um : {-20.0, 20.0}) {
    const Vector3d F = mean_force(off(um), kActual, kErrors);
    const Vector3d expected = wall_force(kWide + um * 1e-6);
    EXPECT_LE((F - expected).norm(), kShare * expected.norm()) << um << ": " << F.transpose();
  }
}

TEST(ActualDepth, is_nominal_by_default) {
  const Vector3d F = mean_force(off(20.0), "", kErrors), expected = wall_force(kWide);
  EXPECT_LE((F - expected).norm(), kShare * expected.norm());
}

// The error along the feed and the lag of the axes change nothing.
TEST(ActualDepth, does_not_follow_an_error_along_the_feed) {
  const Vector3d F = mean_force("[errors.off]\nEXX = { constant_um = 50.0 }\n", kActual, kErrors);
  const Vector3d expected = wall_force(kWide);
  EXPECT_LE((F - expected).norm(), kShare * expected.norm());
}

// The structure gives way until force and deflection agree: F = F(d), d = F / k, solved here.
TEST(ActualDepth, is_in_balance_with_the_deflection) {
  const Vector3d F =
      mean_force("[machine_override.axis.Y]\nstructural_stiffness = \"2 N/um\"\n", kActual);
  double bent = 0.0;
  for (int n = 0; n < 50; ++n) bent = wall_force(kWide + bent).y() / 2e6;
  const Vector3d expected = wall_force(kWide + bent);
  EXPECT_LE((F - expected).norm(), 2.0 * kShare * expected.norm());  // secant over 20 um
  const Vector3d nominal = wall_force(kWide);
  EXPECT_GT((expected - nominal).norm(), 4.0 * kShare * nominal.norm()) << "it matters";
}

// In the mean over the teeth as in the average model.
TEST(ActualDepth, of_single_teeth_has_the_mean_of_the_average_model) {
  const std::string fine = "[record]\nperiod_ms = 0.1\n";
  const Vector3d F = mean_force(off(20.0) + fine, kActual + "force = \"instantaneous\"\n", kErrors);
  const Vector3d expected = wall_force(kWide + 20 * um);
  EXPECT_LE((F - expected).norm(), 2.0 * kShare * expected.norm()) << F.transpose();
}

// 0.1 mm beside the path are what is known.
TEST(ActualDepth, beyond_its_range_is_reported) {
  const auto notes = [](double um) {
    return run_named_case(small_scenario(kWall, kErrors + kTool + kBlock + kSteel + kActual +
                                                    off(um) + one_case("cut")),
                          "cut")
        .notes;
  };
  const auto warns = [](const std::vector<std::string>& all) {
    return std::any_of(all.begin(), all.end(), [](const std::string& note) {
      return note.find(
                 "mm off its nominal path while it cut: forces at the actual depth of cut "
                 "are extrapolated linearly from 0.02 mm to 0.1 mm, and constant beyond") !=
             std::string::npos;
    });
  };
  EXPECT_FALSE(warns(notes(80.0)));
  EXPECT_TRUE(warns(notes(130.0)));
}

// The helix draws the tool into its slot.
TEST(ActualDepth, stops_a_tool_that_digs_in) {
  const auto outcome = [](double stiffness) {
    const model::Scenario scenario = small_scenario(
        kSlot, kTool + kBlock + kSteel + kActual +
                   fmt::format("[machine_override.axis.Z]\nstructural_stiffness = \"{} N/um\"\n",
                               stiffness) +
                   one_case("cut"));
    static const StopFlag kNever = false;
    std::atomic<float> progress = 0.0F;
    return run::run_case(preparation::PreparedCase(scenario, scenario.cases.front()), kNever,
                         progress)
        .result.outcome;
  };
  EXPECT_TRUE(outcome(1.0).finished);
  const Outcome stopped = outcome(0.01);
  EXPECT_FALSE(stopped.finished);
  EXPECT_EQ(stopped.reason.substr(0, 70),
            "the tool digs in: the cut draws it in faster than the structure resist");
}

}  // namespace
}  // namespace servomill::sim::engine::actual_depth_run_test

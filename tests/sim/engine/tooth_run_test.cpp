/// Forces of single teeth in a simulated machine.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/cutting/cutting_force.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/cutting_load.h"
#include "sim/model/scenario.h"
#include "tests/sim/cutting_block.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::engine::tooth_run_test {
namespace {

using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kStep = 0.1 * ms;  // half of the velocity period; 3.14 ms from tooth to tooth
const double kChip = 1394.0 / (4775.0 * 4) * mm;  // feed per tooth

const std::string kStraightTool = kTool + "helix_deg = 0.0\n";
const std::string kTeeth = kSteel + "force = \"instantaneous\"\n";
const std::string kFine = "[record]\nperiod_ms = 0.1\n";
const std::string kElastic =
    "[machine_override.axis.X]\nstructural_stiffness = \"50 N/um\"\n"
    "[machine_override.axis.Y]\nstructural_stiffness = \"40 N/um\"\n"
    "[machine_override.axis.Z]\nstructural_stiffness = \"20 N/um\"\n";

std::vector<std::size_t> middle(const run::CaseOutput& out) {
  return rows_within(out.result.servo, -5.0, 10.0);
}

Vector3d vector_of(const records::Series& servo, const char* name, std::size_t row) {
  const std::size_t column = *servo.column(name, 'X');
  return {servo.at(row, column), servo.at(row, column + 1), servo.at(row, column + 2)};
}

// Two of four straight teeth are in the slot, at phi and phi + 90 deg.
TEST(ToothRun, force_in_a_slot_follows_the_closed_form_at_the_recorded_angle) {
  const run::CaseOutput out = run_named_case(
      small_scenario(kSlot, kStraightTool + kBlock + kTeeth + kFine + one_case("cut")), "cut");
  const records::Series& servo = out.result.servo;
  const plant::CuttingCoefficients& K = plant::find_material("42CrMo4")->typical;
  const std::size_t angle = *servo.column("spindle_angle");
  const double a = 2 * mm, turned = 4775.0 / 60.0 * 2.0 * kPi * kStep;
  double largest = 0.0;
  for (const std::size_t n : middle(out)) {
    const double phi = std::fmod(servo.at(n, angle) * deg, 0.5 * kPi);
    const auto S = [](double x) { return std::sin(x) - std::cos(x); };
    const auto C = [](double x) { return std::sin(x) + std::cos(x); };
    // means over the step, in which a third tooth may take the place of the first
    const double first = std::min(turned, 0.5 * kPi - phi), rest = turned - first;
    const auto mean = [&](auto f) { return (f(phi + first) - f(phi) + f(rest) - f(0.0)) / turned; };
    const double sum = mean(S), difference = mean(C);
    const Vector3d expected(-a * (K.Krc * kChip + K.Kte * difference + K.Kre * sum),
                            a * (K.Ktc * kChip + K.Kte * sum - K.Kre * difference),
                            -a * (K.Kac * kChip * sum + 2.0 * K.Kae));
    largest = std::max(largest, (vector_of(servo, "cutting_force", n) - expected).norm());
  }
  EXPECT_LE(largest, 0.2) << "N of 350: ripple of the feed";
  EXPECT_EQ(servo.find("spindle_angle")->units, "deg");
}

TEST(ToothRun, spindle_turns_evenly_from_the_first_move_to_the_last) {
  const run::CaseOutput out = run_named_case(
      small_scenario(kSlot, kStraightTool + kBlock + kTeeth + kFine + one_case("cut")), "cut");
  const records::Series& servo = out.result.servo;
  const std::size_t angle = *servo.column("spindle_angle"), time = *servo.column("time");
  for (std::size_t n = 1; n < servo.rows(); ++n) {
    const double expected = servo.at(n, time) * 4775.0 / 60.0 * 360.0;
    ASSERT_NEAR(servo.at(n, angle), expected, 1e-6) << n;
  }
}

// Over whole turns, with helix, against the same cut by its average.
TEST(ToothRun, mean_force_is_that_of_the_average_model) {
  const std::string common = kTool + kBlock + kFine + kElastic + one_case("cut");
  const run::CaseOutput teeth = run_named_case(small_scenario(kSlot, kTeeth + common), "cut"),
                        average = run_named_case(small_scenario(kSlot, kSteel + common), "cut");
  std::vector<std::size_t> turns = middle(teeth);
  const double rows_of_turn = 60.0 / 4775.0 / kStep;
  turns.resize(static_cast<std::size_t>(
      std::lround(rows_of_turn * std::floor(static_cast<double>(turns.size()) / rows_of_turn))));
  for (const char axis : {'X', 'Y', 'Z'}) {
    const auto mean = [&](const run::CaseOutput& out, const char* name) {
      return mean_of(out.result.servo, name, axis, turns);
    };
    const double F = mean(average, "cutting_force");
    EXPECT_NEAR(mean(teeth, "cutting_force"), F, 5e-4 * std::abs(F)) << axis;
    const double d = mean(average, "structural_deflection");
    EXPECT_NEAR(mean(teeth, "structural_deflection"), d, 5e-4 * std::abs(d)) << axis;
  }
  EXPECT_FALSE(average.result.servo.column("spindle_angle").has_value());
}

// Deviation of the force from itself a number of teeth later (N), largest.
double change_after(const run::CaseOutput& out, int teeth) {
  const records::Series& servo = out.result.servo;
  const std::vector<std::size_t> rows = middle(out);
  const auto later = static_cast<std::size_t>(teeth) * 30;
  double largest = 0.0;
  for (std::size_t i = 0; i + later < rows.size(); ++i) {
    largest = std::max(largest, (vector_of(servo, "cutting_force", rows[i + later]) -
                                 vector_of(servo, "cutting_force", rows[i]))
                                    .norm());
  }
  return largest;
}

// 5000 1/min: a tooth passes every 3 ms, 30 steps of 0.1 ms.
TEST(ToothRun, run_out_gives_the_force_the_period_of_a_turn) {
  const std::string program =
      "G17 G90 T1 M6\nG43 H1\nS5000 M3\nG0 X-30 Y0\nZ-2\nG1 X30 F1394\nM30\n";
  const auto run = [&](const std::string& runout) {
    return run_named_case(
        small_scenario(program, kStraightTool + runout + kBlock + kTeeth + kFine + one_case("cut")),
        "cut");
  };
  const run::CaseOutput round = run(""), eccentric = run("runout_um = 20.0\n");
  EXPECT_LE(change_after(round, 1), 0.3);
  EXPECT_GE(change_after(eccentric, 1), 20.0);
  EXPECT_LE(change_after(eccentric, 4), 0.3);
}

TEST(ToothRun, of_ideal_axes_is_that_of_their_position_periods) {
  const std::string slow = "G17 G90 T1 M6\nG43 H1\nS75 M3\nG0 X-22 Y0\nZ-2\nG1 X-18 F22\nM30\n";
  const run::CaseOutput out =
      run_named_case(small_scenario(slow, kStraightTool + kBlock + kTeeth +
                                              one_case("cut", "servo = \"ideal\"\n")),
                     "cut");
  const records::Series& servo = out.result.servo;
  double largest = 0.0;
  for (std::size_t n = 0; n < servo.rows(); ++n) {
    largest = std::max(largest, vector_of(servo, "cutting_force", n).norm());
  }
  EXPECT_GT(largest, 100.0);
}

std::string refusal(const std::string& toml) {
  try {
    const model::Scenario scenario = small_scenario(kSlot, toml);
    run_named_case(scenario, "cut");
  } catch (const InputError& error) {
    const std::string text = error.what();
    return text.substr(text.find("error: ") + 7);
  }
  return "";
}

TEST(ToothRun, is_refused_where_the_number_of_teeth_or_the_clamping_is_unknown) {
  const std::string tool = "[[program.tool]]\nnumber = 1\nlength_mm = 110.0\ndiameter_mm = 8.0\n";
  EXPECT_EQ(refusal(tool + kBlock + kTeeth + one_case("cut")),
            "cutting.force = \"instantaneous\"; needs the number of teeth of tool 1");
  EXPECT_EQ(refusal(kTool + "runout_um = 201.0\n" + kBlock + kTeeth + one_case("cut")),
            "program.tool[0].runout_um = 201.0; must be >= 0 and <= 200");
  EXPECT_EQ(refusal(kTool + "runout_um = -1.0\n" + kBlock + kTeeth + one_case("cut")),
            "program.tool[0].runout_um = -1.0; must be >= 0 and <= 200");
  EXPECT_EQ(refusal(kTool + kBlock + kSteel + "steps_per_tooth = 40\n" + one_case("cut")),
            "cutting.steps_per_tooth = 40; needs force = \"instantaneous\"");
  EXPECT_EQ(refusal(kTool + kBlock + kSteel + "force = \"mean\"\n" + one_case("cut")),
            "cutting.force = \"mean\"; must be one of average, instantaneous");
}

}  // namespace
}  // namespace servomill::sim::engine::tooth_run_test

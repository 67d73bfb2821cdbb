/// Errors with hysteresis on a machine that runs a program.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/simulate.h"
#include "sim/model/scenario.h"
#include "sim/preparation/prepare_cases.h"
#include "tests/sim/small_scenario.h"
#include "tests/text.h"

namespace servomill::sim::run::hysteresis_test {
namespace {

// Five targets of X, each approached five times from below and from above as ISO 230-2 asks for,
// with a dwell at each.
constexpr double kTargets[] = {-40.0, -15.0, 3.0, 20.0, 45.0};  // mm
constexpr int kRuns = 5;
constexpr double kDwell = 0.2;  // s

std::string iso_230_2_program(int runs = kRuns) {
  std::string program = "G17 G21 G40 G90 G94\nG0 X-50 Y0 Z0\n";
  const auto stop_at = [&](double x) {
    program += fmt::format("G1 X{:g} F6000\nG4 P{:g}\n", x, kDwell);
  };
  for (int run = 0; run < runs; ++run) {
    for (const double x : kTargets) stop_at(x);
    program += "G1 X50 F6000\n";
    for (std::size_t i = std::size(kTargets); i-- > 0;) stop_at(kTargets[i]);
    program += "G1 X-50 F6000\n";
  }
  return program + "M30\n";
}

const std::string kErrors =
    "[errors.machine.EXX]\npolynomial_um = [1.0, 0.05]\n"
    "reversal = { width_um = 3.0, width_polynomial_um = [1.0, 0.02], distance_mm = 0.5 }\n"
    "[errors.machine.EAX]\nreversal = { width_urad = -8.0, distance_mm = 0.02 }\n"
    "[errors.machine.EYY]\nreversal = { width_um = 5.0, distance_mm = 0.01 }\n";

model::Scenario machine_with_hysteresis(const std::string& program, const std::string& more,
                                        const std::string& errors = kErrors) {
  return small_scenario(program, "machine_errors = \"machine\"\n" + errors + more);
}

std::string one_case(const std::string& name, const std::string& servo) {
  return "[[case]]\nname = \"" + name + "\"\nservo = \"" + servo +
         "\"\n[[case.strategy]]\ntype = \"none\"\n";
}

// Deviations (um) of X at standstill on the targets: [target], from below and from above.
struct Approaches {
  std::vector<double> up[std::size(kTargets)], down[std::size(kTargets)];
};

Approaches approaches_of(const records::Series& series) {
  const std::size_t x = series.column("ref_linear", 'X').value();
  const std::size_t deviation = series.column("tool_deviation", 'X').value();
  const std::size_t actual = series.column("true_linear", 'X').value();
  Approaches out;
  bool up = true;
  std::size_t stood = 0;  // rows
  for (std::size_t n = 1; n < series.rows(); ++n) {
    const double at = series.at(n, x), step = at - series.at(n - 1, x);
    stood = step == 0.0 ? stood + 1 : 0;
    if (step != 0.0) up = step > 0.0;
    if (stood != 10) continue;
    for (std::size_t i = 0; i < std::size(kTargets); ++i) {
      if (std::abs(at - kTargets[i]) > 1e-6) continue;
      const double servo = (series.at(n, actual) - at) * 1e3;
      (up ? out.up : out.down)[i].push_back(series.at(n, deviation) - servo);
    }
  }
  return out;
}

double mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

// B_i of ISO 230-2 is the stated width, the mean of both directions the stated mean.
TEST(Hysteresis, GivesTheReversalValuesOfIso230) {
  const std::string cases = one_case("ideal", "ideal") + one_case("servo", "cascade");
  const model::Scenario scenario =
      machine_with_hysteresis(iso_230_2_program(), "[record]\nperiod_ms = 10.0\n" + cases);
  constexpr double kIdealTol = 1e-5;  // um: distances in the workpiece are of 0.1 m, doubles in mm
  // um: a drive overshoots by 3 um, 1.2 % of half the distance, and comes back: 1.5 x (1.2 %)^2 of
  // some 3 um are lost
  constexpr double kServoTol = 2e-3;
  for (const std::string name : {"ideal", "servo"}) {
    const double kTol = name == "ideal" ? kIdealTol : kServoTol;
    const CaseOutput output = run_named_case(scenario, name);
    const Approaches found = approaches_of(output.result.servo);
    for (std::size_t i = 0; i < std::size(kTargets); ++i) {
      const double x = kTargets[i];
      ASSERT_EQ(found.up[i].size(), kRuns) << name;
      ASSERT_EQ(found.down[i].size(), kRuns) << name;
      const double up = mean(found.up[i]), down = mean(found.down[i]);
      EXPECT_NEAR(up - down, 4.0 + 0.02 * x, kTol) << name << ", target " << x;
      EXPECT_NEAR(0.5 * (up + down), 1.0 + 0.05 * x, kTol) << name << ", target " << x;
      for (int run = 0; run < kRuns; ++run) {
        EXPECT_NEAR(found.up[i][static_cast<std::size_t>(run)], up, kTol) << name;
      }
    }
  }
}

constexpr const char* kToAndFro =
    "G17 G21 G40 G90 G94\nG1 X1 Y0.5 F1000\nX0.4 Y0\nX0.41\nX0.38 Y0.7\nX0.9\nM30\n";

// The truth is advanced by the clock of the machine: recording only looks.
TEST(Hysteresis, IsTheSameHoweverOftenItIsRecorded) {
  const auto run_with = [](const std::string& period) {
    return run_named_case(
        machine_with_hysteresis(
            kToAndFro, "[record]\nperiod_ms = " + period + "\n" + one_case("servo", "cascade")),
        "servo");
  };
  const CaseOutput often = run_with("1.0"), rarely = run_with("5.0");
  const records::Series &a = often.result.servo, &b = rarely.result.servo;
  const std::size_t x = a.column("tool_deviation", 'X').value();
  ASSERT_GT(b.rows(), 20U);
  for (std::size_t n = 0; n < b.rows(); ++n) EXPECT_EQ(a.at(5 * n, x), b.at(n, x)) << n;
}

TEST(Hysteresis, GivesTheSameBitsInLockstepAsAlone) {
  const model::Scenario scenario = machine_with_hysteresis(
      kToAndFro, one_case("one", "cascade") + one_case("lag", "cascade") +
                     "[case.machine_override.nc]\nvelocity_feed_forward = 0.0\n" +
                     one_case("three", "cascade"));
  const std::vector<preparation::PreparedCase> prepared = preparation::prepare_cases(scenario);
  std::vector<engine::CaseInputs> inputs;
  inputs.reserve(prepared.size());
  std::vector<engine::CaseInputs*> together;
  for (const preparation::PreparedCase& one : prepared) {
    inputs.push_back(one.inputs());
    together.push_back(&inputs.back());
    ASSERT_TRUE(engine::share_lanes(inputs.front(), inputs.back()));
  }
  const engine::StopFlag never = false;
  std::atomic<float> progress = 0.0F;
  const std::vector<engine::CaseResult> results = engine::simulate(together, never, progress);
  for (std::size_t n = 0; n < prepared.size(); ++n) {
    const CaseOutput alone = run_named_case(scenario, prepared[n].spec().name);
    EXPECT_EQ(results[n].servo.by_rows(), alone.result.servo.by_rows()) << prepared[n].spec().name;
  }
  EXPECT_NE(results[0].servo.by_rows(), results[1].servo.by_rows());
}

// A series of a machine without jumps: from row to row the error changes by less than its
// steepest slope times the travel.
TEST(Hysteresis, ChangesOverWithoutAJump) {
  const std::string errors =
      "[errors.machine.EYX]\nreversal = { width_um = 10.0, distance_mm = 0.05 }\n";
  const std::string program = "G17 G21 G40 G90 G94\nG1 X1 F1000\nX0.4\nX0.41\nX0.38\nX0.9\nM30\n";
  const CaseOutput output = run_named_case(
      machine_with_hysteresis(program, "[record]\nperiod_ms = 0.6\n" + one_case("ideal", "ideal"),
                              errors),
      "ideal");
  const records::Series& series = output.result.servo;
  const std::size_t x = series.column("true_linear", 'X').value();
  const std::size_t y = series.column("tool_deviation", 'Y').value();
  constexpr double kSteepest = 1.5 * 0.5 * 10.0 / (0.5 * 0.05);  // um/mm
  constexpr double kTol = 1e-6;                                  // um, doubles in mm
  double least = 0.0, most = 0.0;
  for (std::size_t n = 1; n < series.rows(); ++n) {
    const double travel = std::abs(series.at(n, x) - series.at(n - 1, x));
    EXPECT_LE(std::abs(series.at(n, y) - series.at(n - 1, y)), kSteepest * travel + kTol) << n;
    least = std::min(least, series.at(n, y));
    most = std::max(most, series.at(n, y));
  }
  EXPECT_NEAR(most, 5.0, 1e-6);
  EXPECT_NEAR(least, -5.0, 1e-6);
}

// Strategies know the mean: it is corrected, half the width stays on either side.
TEST(Hysteresis, LeavesHalfItsWidthToACorrectionByTheMean) {
  const std::string corrected =
      "[[case]]\nname = \"feedback\"\nservo = \"ideal\"\n[[case.strategy]]\ntype = \"feedback\"\n"
      "model = \"machine\"\naction = \"compensate\"\n";
  const std::string errors =
      "[errors.machine.EXX]\npolynomial_um = [1.0, 0.05]\n"
      "reversal = { width_um = 4.0, distance_mm = 0.05 }\n";
  const CaseOutput output =
      run_named_case(machine_with_hysteresis(iso_230_2_program(1),
                                             "[record]\nperiod_ms = 10.0\n" + corrected, errors),
                     "feedback");
  const records::Series& series = output.result.servo;
  const std::size_t deviation = series.column("tool_deviation", 'X').value();
  double least = 0.0, most = 0.0;
  for (std::size_t n = 0; n < series.rows(); ++n) {
    least = std::min(least, series.at(n, deviation));
    most = std::max(most, series.at(n, deviation));
  }
  EXPECT_NEAR(most, 2.0, 1e-4);
  EXPECT_NEAR(least, -2.0, 1e-4);
}

std::string fault_of(const std::string& errors) {
  return fault_messages(
      [&] { machine_with_hysteresis(kToAndFro, one_case("ideal", "ideal"), errors); });
}

TEST(Hysteresis, IsRefusedWhereItCannotBe) {
  EXPECT_EQ(fault_of("[errors.machine.EXX]\nreversal = { width_um = 3.0, distance_mm = 0.0 }\n"),
            "errors.machine.EXX.reversal.distance_mm = 0.0; must be > 0\n");
  EXPECT_EQ(fault_of("[errors.machine.EXX]\nreversal = { width_um = 3.0 }\n"),
            "errors.machine.EXX.reversal.distance_mm is missing\n");
  EXPECT_EQ(fault_of("[errors.machine.EXX]\nreversal = { distance_mm = 0.02 }\n"),
            "errors.machine.EXX.reversal.width_um is missing\n");
  EXPECT_EQ(fault_of("[errors.machine.EXX]\nreversal = { width_mm = 3.0, distance_mm = 0.02 }\n"),
            "errors.machine.EXX.reversal.width_um is missing\n"
            "errors.machine.EXX.reversal.width_mm is not known; did you mean 'width_um'?\n");
  EXPECT_EQ(fault_of("[errors.machine.EXC]\nreversal = { width_um = 3.0, distance_mm = 0.02 }\n"),
            "errors.machine.EXC.reversal.distance_deg is missing\n"
            "errors.machine.EXC.reversal.distance_mm is not known; did you mean 'distance_deg'?\n");
}

// Largest less smallest distance (um) of the TCP from the centre of a circle, on it.
double roundness(const model::Scenario& scenario, const std::string& name) {
  const CaseOutput output = run_named_case(scenario, name);
  const records::Series& series = output.result.servo;
  const std::size_t section = series.column("section").value();
  const std::size_t x = series.column("tool_position_true", 'X').value();
  const std::size_t y = series.column("tool_position_true", 'Y').value();
  double least = 1e9, most = 0.0;
  for (std::size_t n = 0; n < series.rows(); ++n) {
    if (series.at(n, section) < 1.0) continue;
    const double r = std::hypot(series.at(n, x), series.at(n, y));
    least = std::min(least, r);
    most = std::max(most, r);
  }
  return (most - least) * 1e3;
}

// Lost motion alone, on a circle that begins and ends at 30 degrees: uncorrected it is out of round
// by its width, corrected by the chords of the blocks and by what the servo loops leave without
// errors, too.
TEST(Hysteresis, IsCompensatedOnCirclesByARewrittenProgram) {
  constexpr double kChords = 0.2;  // um, two tolerances
  for (const std::string turn : {"G2", "G3"}) {
    const std::string program = "G17 G21 G90 G94 G61\nG0 X17.320508 Y10\nG1 F600\n" + turn +
                                " X17.320508 Y10 I-17.320508 J-10\n(MSG, circle)\n" + turn +
                                " X17.320508 Y10 I-17.320508 J-10\nM30\n";
    const std::string gcode =
        "[[case.strategy]]\ntype = \"gcode\"\nmodel = \"machine\"\naction = \"compensate\"\n";
    const std::string cases =
        "[[case]]\nname = \"as_it_is\"\nservo = \"ideal\"\n"
        "[[case]]\nname = \"ideal\"\nservo = \"ideal\"\n" +
        gcode + "[[case]]\nname = \"servo\"\n" + gcode +
        "[[case]]\nname = \"perfect\"\nmachine_errors = \"\"\n";
    const model::Scenario scenario = machine_with_hysteresis(
        program, "[record]\nperiod_ms = 3.0\n" + cases,
        "[errors.machine]\nEXX = { reversal = { width_um = -3.0, distance_mm = 0.05 } }\n"
        "EYY = \"EXX\"\n");
    EXPECT_GT(roundness(scenario, "as_it_is"), 2.5) << turn;
    EXPECT_LT(roundness(scenario, "ideal"), kChords) << turn;
    EXPECT_LT(roundness(scenario, "servo"), roundness(scenario, "perfect") + kChords) << turn;
  }
}

}  // namespace
}  // namespace servomill::sim::run::hysteresis_test

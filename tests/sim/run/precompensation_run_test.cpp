/// Predictive precompensation: what it leaves with perfect and with wrong knowledge, and what it
/// asks of the axes.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/offset_response.h"
#include "sim/run/run_output.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::precompensation_run_test {
namespace {

using Complex = std::complex<double>;

// Errors of 11 um at most on the programs below, which turn within 10 to 30 mm.
const std::string kErrors =
    "[errors.machine]\n"
    "EXX = { um_per_m = 60.0, harmonic = { amplitude_um = 3.0, period_mm = 20.0 } }\n"
    "EYX = { harmonic = { amplitude_um = 4.0, period_mm = 30.0 } }\n"
    "EXY = { polynomial_um = [2.0, 0.2] }\n"
    "EZY = { harmonic = { amplitude_um = 3.0, period_mm = 25.0 } }\n"
    "EC0Y = \"50 urad\"\n"
    "EBX = { polynomial_urad = [5.0, 0.5] }\n"
    "EAY = { harmonic = { amplitude_urad = 10.0, period_mm = 30.0 } }\n";
// Corners, a quarter of a circle.
const std::string kProgram =
    "G17 G21 G90 G94 G64 P0.01\nG1 X20 F3000\nG3 X20 Y20 J10\nG1 X0\nG1 Y5 Z10\nM30\n";
const std::string kTurns =
    "G17 G21 G90 G94 G64 P0.01\nG1 X20 B30 F3000\nG1 Y20 C40 B50\nG1 X0 Z10 C60\nM30\n";

// A case on a machine with these errors ("": none), with what stands behind in its table.
std::string one_case(const std::string& name, const std::string& errors,
                     const std::string& more = "") {
  return fmt::format("[[case]]\nname = \"{}\"\nmachine_errors = \"{}\"\n{}", name, errors, more);
}

std::string precompensated(const std::string& more = "") {
  return "[[case.strategy]]\ntype = \"precompensation\"\nmodel = \"machine\"\n" + more;
}

struct Residual {
  double rms = 0.0, largest = 0.0;  // um
  double axis = 0.0;                // urad, largest of the tool axis
};

// Tip and tool axis of a run, less those of another one at the same instant, in feed motion.
Residual residual_of(const CaseOutput& one, const CaseOutput& wanted) {
  const records::Series &is = one.result.servo, &ideal = wanted.result.servo;
  EXPECT_EQ(is.rows(), ideal.rows());
  const std::size_t p = *is.column("tool_position_true", 'X');
  const std::size_t k = *is.column("tool_axis_true", 'I');
  const std::size_t time = *is.column("time"), rapid = *is.column("rapid");
  EXPECT_EQ(p, *ideal.column("tool_position_true", 'X'));
  const auto off = [&](std::size_t n, std::size_t first) {
    return std::hypot(is.at(n, first) - ideal.at(n, first),
                      is.at(n, first + 1) - ideal.at(n, first + 1),
                      is.at(n, first + 2) - ideal.at(n, first + 2));
  };
  Residual out;
  double squares = 0.0, rows = 0.0;
  for (std::size_t n = 0; n < std::min(is.rows(), ideal.rows()); ++n) {
    if (is.at(n, rapid) != 0.0 || is.at(n, time) > wanted.duration) continue;
    const double size = off(n, p) * mm / um;
    squares += size * size;
    rows += 1.0;
    out.largest = std::max(out.largest, size);
    out.axis = std::max(out.axis, off(n, k) / urad);
  }
  EXPECT_GT(rows, 500.0);
  out.rms = std::sqrt(squares / rows);
  return out;
}

constexpr const char* kExactRows = "[record]\nperiod_ms = 0.2\nresolution_nm = 0.0\n";
constexpr const char* kIdeal = "servo = \"ideal\"\n";
constexpr const char* kNothing = "residual_um = 0.001\n";
constexpr double kNoTip = 0.001;  // um: what the runs were asked for
constexpr double kNoAxis = 0.01;  // urad: as far as a tool of 100 mm tips by that

// Residuals of "pre" and "plain" from "ideal", which has no errors.
std::array<Residual, 2> residuals(const model::Scenario& scenario) {
  const CaseOutput ideal = run_named_case(scenario, "ideal");
  return {residual_of(run_named_case(scenario, "pre"), ideal),
          residual_of(run_named_case(scenario, "plain"), ideal)};
}

std::string ideal_cases(const std::string& strategy) {
  return kErrors + one_case("ideal", "", kIdeal) + one_case("plain", "machine", kIdeal) +
         one_case("pre", "machine", kIdeal + strategy);
}

TEST(Precompensation, OfAPerfectlyKnownMachineLeavesNothingOfTheTip) {
  const auto [left, plain] =
      residuals(small_scenario(kProgram, ideal_cases(precompensated(kNothing))));
  RecordProperty("residual", fmt::format("{:.5f} of {:.3f} um", left.largest, plain.largest));
  EXPECT_GT(plain.largest, 5.0);
  EXPECT_LT(left.largest, kNoTip);
  EXPECT_NEAR(left.axis, plain.axis, 0.1) << "linear axes tilt nothing";
}

TEST(Precompensation, OfAllAxesLeavesNothingOfTheToolAxisEither) {
  const auto [left, plain] =
      residuals(small_scenario(kTurns, ideal_cases(precompensated("axes = \"all\"\n") + kNothing)));
  RecordProperty("residual", fmt::format("{:.5f} of {:.3f} um, {:.5f} of {:.3f} urad", left.largest,
                                         plain.largest, left.axis, plain.axis));
  EXPECT_GT(plain.largest, 5.0);
  EXPECT_GT(plain.axis, 10.0);
  EXPECT_LT(left.largest, kNoTip);
  EXPECT_LT(left.axis, kNoAxis);
}

TEST(Precompensation, WithLinearAxesLeavesTheTiltOfTheTool) {
  const auto [left, plain] =
      residuals(small_scenario(kTurns, ideal_cases(precompensated(kNothing))));
  EXPECT_LT(left.largest, kNoTip);
  EXPECT_NEAR(left.axis, plain.axis, 0.1);
}

// 80 % of each error is known: a fifth of the vector is left, up to errors of the errors.
TEST(Precompensation, LeavesTheShareOfTheErrorsThatItDoesNotKnow) {
  const std::string errors =
      "[errors.actual]\nEYX = { harmonic = { amplitude_um = 5.0, period_mm = 30.0 } }\n"
      "EXY = { polynomial_um = [0.0, 0.5] }\n"
      "[errors.machine]\nEYX = { harmonic = { amplitude_um = 4.0, period_mm = 30.0 } }\n"
      "EXY = { polynomial_um = [0.0, 0.4] }\n";
  const auto [left, plain] = residuals(small_scenario(
      kProgram, errors + one_case("ideal", "", kIdeal) + one_case("plain", "actual", kIdeal) +
                    one_case("pre", "actual", kIdeal + precompensated(kNothing))));
  EXPECT_NEAR(left.rms, 0.2 * plain.rms, 1e-3 * plain.rms);
  EXPECT_NEAR(left.largest, 0.2 * plain.largest, 1e-3 * plain.largest);
}

const std::string kSwinging =
    "[machine_override]\nfriction_model = \"lugre\"\n[machine_override.inertial_deflection]\n"
    "XX = { gain_um_per_m_s2 = 2.0, frequency_Hz = 48.0, damping = 0.04 }\n"
    "YY = { gain_um_per_m_s2 = 1.0, frequency_Hz = 41.0, damping = 0.05 }\n";
const std::string kRigid =
    "[case.machine_override.inertial_deflection]\nXX = { gain_um_per_m_s2 = 0.0 }\n"
    "YY = { gain_um_per_m_s2 = 0.0 }\n";

// Presliding and breakaway at the reversals of the circle, a structure that swings at 41 and 48 Hz.
TEST(Precompensation, OfAKnownMachineWithFrictionAndInertiaLeavesTwoPerCent) {
  const auto [left, plain] = residuals(small_scenario(
      kProgram, kSwinging + kErrors + one_case("ideal", "", kIdeal + kRigid) +
                    one_case("plain", "machine") + one_case("pre", "machine", precompensated())));
  RecordProperty("residual", fmt::format("{:.4f} of {:.3f} um", left.rms, plain.rms));
  EXPECT_GT(plain.rms, 5.0);
  EXPECT_LT(left.rms, 0.02 * plain.rms);
}

// Complex amplitude (um) of the tip along an axis, less that of another run at the same instant: by
// the sums over the whole turn of the section "turn".
Complex amplitude_of(const CaseOutput& one, const CaseOutput& wanted, char axis, double f) {
  const records::Series &is = one.result.servo, &ideal = wanted.result.servo;
  const std::size_t p = *is.column("tool_position_true", axis), time = *is.column("time");
  const std::size_t section = *is.column("section");
  Complex sum = 0.0;
  double rows = 0.0;
  for (std::size_t n = 0; n < is.rows(); ++n) {
    if (is.at(n, section) != 1.0) continue;
    sum += (is.at(n, p) - ideal.at(n, p)) * mm / um *
           std::polar(1.0, -2.0 * std::numbers::pi * f * is.at(n, time));
    rows += 1.0;
  }
  EXPECT_NEAR(rows * 0.2 * ms * f, 1.0, 1e-3) << "a whole turn";
  return 2.0 * sum / rows;
}

// Loops in lag mode on a circle of 5 rad/s: an axis lags by (1 - P) r, and a model with a gain of
// its own predicts another lag. What is left is that of the machine less what the offset makes
// there of the lag of the model, and by the lags r (1 - P_actual / P_known).
TEST(Precompensation, WithAWrongGainLeavesWhatTheResponsesPredict) {
  constexpr double kRadius = 20e3, kW = 5.0, kKv = 83.0;  // um, rad/s, 1/s
  constexpr double f = kW / (2.0 * std::numbers::pi);
  const std::string circles =
      "G17 G21 G90 G94 G64 P0.001\nG0 X20 Y0\nG3 X20 Y0 I-20 F6000\n"
      "(MSG, turn)\nG3 X20 Y0 I-20\n(MSG, end)\nG3 X20 Y0 I-20\nM30\n";
  const auto gain = [&](double share) { return fmt::format("nc.Kv = {:.3f}\n", share * kKv); };
  for (const double share : {0.9, 1.1}) {
    const model::Scenario scenario = small_scenario(
        circles,
        "[machine_override.nc]\nKv = 83.0\nvelocity_feed_forward = 0.0\n"
        "acceleration_feed_forward = 0.0\n" +
            std::string(kExactRows) + kErrors + one_case("ideal", "", kIdeal) +
            one_case("actual", "") +
            one_case("known", "", "[case.machine_override]\n" + gain(share)) +
            one_case("pre", "",
                     "[[case.strategy]]\ntype = \"precompensation\"\nmodel = \"none\"\n"
                     "[case.strategy.machine]\n" +
                         gain(share)) +
            "[errors.none]\n");
    const CaseOutput ideal = run_named_case(scenario, "ideal");
    const auto response = [&](const char* name, int joint) {
      const model::CaseSpec& spec = *scenario.find_case(name);
      return preparation::OffsetResponses(scenario.machine_of(spec),
                                          scenario.machine_of(spec).joints(),
                                          scenario.reading_delay_of(spec), std::nullopt)
          .at(joint, f);
    };
    for (const int joint : {0, 1}) {
      const char axis = joint == 0 ? 'X' : 'Y';
      const auto amplitude = [&](const char* name) {
        return amplitude_of(run_named_case(scenario, name), ideal, axis, f);
      };
      const Complex of_actual = amplitude("actual");
      const Complex ratio = response("actual", joint) / response("known", joint);
      const double left = std::abs(amplitude("pre"));
      const double predicted = std::abs(of_actual - ratio * amplitude("known"));
      RecordProperty(fmt::format("{} {}", axis, share),
                     fmt::format("{:.2f} of {:.0f} um, predicted {:.2f}, {:.2f}", left,
                                 std::abs(of_actual), predicted, kRadius * std::abs(1.0 - ratio)));
      EXPECT_NEAR(left, predicted, 0.02 * predicted) << axis << share;
      EXPECT_NEAR(left, kRadius * std::abs(1.0 - ratio), 0.02 * left) << axis << share;
      // first-order loops, r w (1/Kv_known - 1/Kv)
      EXPECT_NEAR(left, kRadius * kW / kKv * std::abs(1.0 / share - 1.0), 0.1 * left);
      EXPECT_GT(std::abs(of_actual), 8.0 * left);
    }
  }
}

// Largest velocity, acceleration and jerk (m/s ...) of an axis, as differences of its recorded
// commands from one position period to the next.
std::array<double, 3> demands_of(const CaseOutput& one, char axis) {
  constexpr double h = 0.2 * ms;
  const records::Series& servo = one.result.servo;
  const std::size_t column = *servo.column("cmd_linear", axis);
  std::array<double, 4> x = {};  // the position and its differences, at the row before
  std::array<double, 3> most = {};
  for (std::size_t n = 0; n < servo.rows(); ++n) {
    std::array<double, 4> now = {servo.at(n, column) * mm};
    for (std::size_t k = 0; k < 3; ++k) {
      now[k + 1] = (now[k] - x[k]) / h;
      if (n > k) most[k] = std::max(most[k], std::abs(now[k + 1]));
    }
    x = now;
  }
  return most;
}

// Corners at the limits of the axes: what they leave of the jerk is less than the offset asks for.
model::Scenario at_limits() {
  std::string cases = one_case("plain", "machine");
  for (const char* limits : {"smooth", "slow", "ignore"}) {
    cases += one_case(limits, "machine", precompensated(fmt::format("limits = \"{}\"\n", limits)));
  }
  return small_scenario(
      "G17 G21 G90 G94 G64 P0.01\nG4 P0.6\nG1 X60 F20000\nG1 Y30\nG3 X50 Y20 J-10\nG1 X10\n"
      "G4 P0.6\nM30\n",
      kSwinging + kExactRows + kErrors + cases);
}

constexpr std::array<double, 3> kLimits = {40.0 / 60.0, 6.0, 100.0};  // m/s ..., X, Y and Z
constexpr double kRounding = 0.002;  // share of a limit: of offsets as they are accepted

void expect_within_limits(const CaseOutput& one, std::size_t order) {
  for (const char axis : {'X', 'Y', 'Z'}) {
    EXPECT_LE(demands_of(one, axis)[order], (1.0 + kRounding) * kLimits[order])
        << one.name << " " << axis;
  }
}

int count_notes(const CaseOutput& one, const char* text) {
  return static_cast<int>(std::count_if(one.notes.begin(), one.notes.end(), [&](const auto& note) {
    return note.find(text) != std::string::npos;
  }));
}

TEST(Precompensation, KeepsVelocityAndAccelerationOfEveryAxisUnlessItIgnoresThem) {
  const model::Scenario scenario = at_limits();
  for (const char* name : {"plain", "smooth", "slow"}) {
    const CaseOutput one = run_named_case(scenario, name);
    expect_within_limits(one, 0);
    expect_within_limits(one, 1);
  }
}

TEST(Precompensation, KeepsTheJerkOfEveryAxisUnlessItIgnoresIt) {
  const model::Scenario scenario = at_limits();
  for (const char* name : {"plain", "smooth", "slow"}) {
    expect_within_limits(run_named_case(scenario, name), 2);
  }
}

TEST(Precompensation, TakesTheTimeOfThePathUnlessItSlowsIt) {
  const model::Scenario scenario = at_limits();
  const double plain = run_named_case(scenario, "plain").duration;
  const CaseOutput smooth = run_named_case(scenario, "smooth"),
                   slow = run_named_case(scenario, "slow"),
                   ignore = run_named_case(scenario, "ignore");
  EXPECT_EQ(smooth.duration, plain);
  EXPECT_EQ(ignore.duration, plain);
  EXPECT_GT(slow.duration, 1.01 * plain);
  EXPECT_EQ(slow.notes.front(),
            fmt::format("case slow: strategy precompensation: the motion takes {:.4g} s, {:.2g} % "
                        "more than without it",
                        slow.duration, 100.0 * (slow.duration / plain - 1.0)));
  for (const CaseOutput* one : {&smooth, &ignore}) {
    EXPECT_EQ(count_notes(*one, "the motion takes"), 0) << one->name;
  }
}

TEST(Precompensation, WarnsOfLimitsThatItIgnores) {
  const model::Scenario scenario = at_limits();
  for (const char* name : {"smooth", "slow"}) {
    EXPECT_EQ(count_notes(run_named_case(scenario, name), "exceed limits"), 0) << name;
  }
  const CaseOutput ignore = run_named_case(scenario, "ignore");
  EXPECT_EQ(count_notes(ignore,
                        "small.ngc: warning: case ignore: path and offset together exceed "
                        "limits: "),
            1);
  for (const char axis : {'X', 'Y'}) {
    EXPECT_GT(demands_of(ignore, axis)[2], 1.05 * kLimits[2]) << axis;
    EXPECT_EQ(count_notes(ignore, fmt::format("jerk of {} ", axis).c_str()), 1) << axis;
  }
}

// Every fault of a scenario, without the folder of its file.
std::string refusal(const std::string& toml) { return refusal_of("[errors.machine]\n" + toml); }

TEST(Precompensation, RefusesToKnowAnotherMachine) {
  for (const char* machine :
       {"\"machines/router_3axis.toml\"", "\"machines/generic_trunnion_ac.toml\"",
        "{ nc = { position_period_us = 400 } }", "{ nc = { scale_delay_us = 100 } }"}) {
    EXPECT_EQ(
        refusal(one_case("one", "machine", precompensated(fmt::format("machine = {}\n", machine)))),
        "small.toml:9:11: error: case one: strategy precompensation: machine is another one: its "
        "structure, the periods of its loops and nc.scale_delay_us must be those of the scenario's "
        "machine");
  }
}

TEST(Precompensation, RefusesToImposeAndToOccurTwice) {
  EXPECT_EQ(refusal(one_case("one", "machine", precompensated("action = \"impose\"\n"))),
            "small.toml:9:10: error: case[0].strategy[0].action = \"impose\"; must be "
            "\"compensate\": the strategy precompensation cannot impose errors");
  EXPECT_EQ(refusal(one_case("one", "machine", precompensated() + precompensated())),
            "small.toml:7:8: error: case one: strategy precompensation appears twice; each would "
            "correct the whole");
}

TEST(Precompensation, RefusesAModelThatStops) {
  EXPECT_EQ(refusal(one_case(
                "one", "machine",
                precompensated("machine = { nc = { following_error_limit_mm = 0.001 } }\n"))),
            "small.toml:7:8: error: case one: strategy precompensation: run 1 of the program "
            "stops: axis X: following error beyond 0.001 mm at 0.0044 s");
}

TEST(Precompensation, GivesTheSameBitsForAnyNumberOfThreads) {
  const auto run = [](unsigned threads) {
    RunControl control;
    control.threads = threads;
    return run_scenario(
        small_scenario(kProgram, kSwinging + kErrors + one_case("plain", "machine") +
                                     one_case("pre", "machine", precompensated()) +
                                     one_case("program", "machine",
                                              precompensated("as = \"program\"\nmax_runs = 2\n"))),
        control);
  };
  const RunOutput reference = run(1);
  ASSERT_EQ(reference.cases.size(), 3U);
  EXPECT_NE(reference.cases[0].result.servo.by_rows(), reference.cases[1].result.servo.by_rows());
  for (const unsigned threads : {1U, 2U}) {
    const RunOutput again = run(threads);
    for (std::size_t k = 0; k < again.cases.size(); ++k) {
      const auto &text = again.cases[k].program, &wanted = reference.cases[k].program;
      ASSERT_EQ(text != nullptr, wanted != nullptr);
      EXPECT_TRUE(text == nullptr || *text == *wanted);
      EXPECT_EQ(again.cases[k].result.servo.by_rows(), reference.cases[k].result.servo.by_rows())
          << again.cases[k].name << ", threads " << threads;
    }
  }
}

}  // namespace
}  // namespace servomill::sim::run::precompensation_run_test

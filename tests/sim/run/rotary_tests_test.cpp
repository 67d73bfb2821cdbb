/// Tests of rotary axes that a run makes: closed forms of single errors, and the same sheet from
/// the files.
#include "sim/run/rotary_tests.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "sim/run/machine_tests.h"
#include "sim/run/test_sheet.h"
#include "sim/standards/ball_test.h"
#include "sim/standards/error_motion.h"
#include "sim/standards/positioning_readings.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::rotary_tests_test {
namespace {

const std::string kTool = "[[program.tool]]\nnumber = 1\nlength_mm = 100.0\n";
const std::string kTargets =
    "[[test]]\nname = \"C\"\nstandard = \"iso230-2\"\naxis = \"C\"\ntargets_deg = [0, 50, 120, "
    "200, "
    "330]\nruns = 2\nrotary_feed = \"30 rpm\"\ndwell_s = 0.2\n";
const std::string kTable =
    "[[test]]\nname = \"table\"\nstandard = \"iso230-7\"\naxis = \"C\"\nrevolutions = 2\n"
    "reading_count = 720\ndistance_mm = 100\nrotary_feed = \"10 rpm\"\ndwell_s = 0.2\n"
    "at = { X_mm = 0, Y_mm = 0, Z_mm = 50 }\n";
constexpr double kArm = 90.0 * mm;
const std::string kBall =
    "[[test]]\nname = \"ball\"\nstandard = \"iso10791-6\"\naxis = \"C\"\nfrom_deg = 0\nto_deg = "
    "360\nreading_count = 361\nrotary_feed = \"10 rpm\"\ndwell_s = 0.2\ntool = 1\n"
    "at = { X_mm = 90, Y_mm = 0, Z_mm = 120 }\n";

model::Scenario scenario_of(const std::string& errors, const std::string& test,
                            const std::string& servo, const std::string& more = kTool) {
  return input::read_resolved_scenario(
      "machine = \"machines/hsm600u.toml\"\nmachine_errors = \"actual\"\n[errors.actual]\n" +
          errors + "\n" + test + more + "[[case]]\nname = \"ideal\"\n" + servo,
      SERVOMILL_SOURCE_DIR "/scenarios/small.toml");
}

TestResult tested(const std::string& errors, const std::string& test,
                  const std::string& servo = "servo = \"ideal\"\n") {
  return *run_named_case(scenario_of(errors, test, servo), "ideal").tests.at(0);
}

double value(const TestResult& result, const std::string& symbol) {
  for (const standards::ReportValue& one : result.report.values) {
    if (one.symbol == symbol) return one.value;
  }
  ADD_FAILURE() << symbol;
  return 0.0;
}

constexpr double kRounding = 2e-11;    // rad: directions are recorded in steps of 1 pm at 1 m
constexpr double kNothing = 1.0 * nm;  // errors of second order, (20 um)^2 / 100 mm and the like

// ---- ISO 230-2

TEST(RotaryPositioning, OfALinearErrorGivesItsRange) {
  const TestResult result = tested("ECC = { polynomial_urad = [3.0, 0.5] }", kTargets);
  const double error = 0.5 * urad * 330;
  for (const char* const symbol : {"E", "E_up", "E_down", "M", "A"}) {
    EXPECT_NEAR(value(result, symbol), error, kRounding) << symbol;
  }
  for (const char* const symbol : {"B", "R", "R_up"}) {
    EXPECT_NEAR(value(result, symbol), 0.0, kRounding) << symbol;
  }
  EXPECT_TRUE(result.lines.at(0).test.angular);
  EXPECT_NEAR(result.lines[0].test.up(2, 0), 0.5 * urad * 120, kRounding);
  EXPECT_LT(result.creep, kRounding);
}

TEST(RotaryPositioning, OfALostMotionGivesItsWidthAsReversalError) {
  const TestResult result =
      tested("ECC = { reversal = { width_urad = 20.0, distance_deg = 0.1 } }", kTargets);
  EXPECT_NEAR(value(result, "B_mean"), 20.0 * urad, kRounding);
  EXPECT_NEAR(value(result, "M"), 0.0, kRounding);
}

// The device sees rotation about the axis alone.
TEST(RotaryPositioning, DoesNotSeeTheOtherErrorsOfTheAxis) {
  for (const std::string error :
       {"EXC = { constant_um = 20.0 }\nEYC = { harmonic = { amplitude_um = 20.0, period_deg = 90 } "
        "}",
        "EZC = { harmonic = { amplitude_um = 20.0, period_deg = 360 } }", "EX0C = \"20 um\"",
        "EAC = { harmonic = { amplitude_urad = 20.0, period_deg = 180 } }", "EB0C = \"20 urad\""}) {
    EXPECT_NEAR(value(tested(error, kTargets), "E"), 0.0, 1e-9) << error;
  }
}

// A swivel axis, wherever the table is turned to, with a tool and a work offset.
TEST(RotaryPositioning, FollowsTheAttitudeOfTheAxis) {
  const std::string swivel =
      "[[test]]\nname = \"B\"\nstandard = \"iso230-2\"\naxis = \"B\"\nfrom_deg = -60\nto_deg = 60\n"
      "runs = 2\nrotary_feed = \"10 rpm\"\ndwell_s = 0.2\ntool = 1\nat = { C_deg = 70 }\n";
  const TestResult result = tested("EBB = { polynomial_urad = [0.0, 0.5] }",
                                   swivel + "[program.work_offset]\nX_mm = 30.0\nC_deg = 11.0\n");
  EXPECT_NEAR(value(result, "E"), 60 * urad, kRounding);
  EXPECT_NEAR(result.lines.at(0).test.up(4, 1), 60 * urad, kRounding);
  EXPECT_EQ(result.lines[0].test.targets.size(), 5);  // ISO 230-2, table 1: up to 180 deg
}

const std::string kAutocollimator =
    "seed = 5\n[test.device]\nresolution_urad = 0.5\nvariation_urad = 2.0\n"
    "target_uncertainty_urad = 1.0\n";

TEST(RotaryPositioning, StatesTheUncertaintyOfItsDevice) {
  const TestResult exact = tested("ECC = { polynomial_urad = [0.0, 0.5] }", kTargets);
  const TestResult read =
      tested("ECC = { polynomial_urad = [0.0, 0.5] }", kTargets + kAutocollimator);
  for (std::size_t k = 0; k < read.report.values.size(); ++k) {
    const standards::ReportValue& one = read.report.values[k];
    EXPECT_GT(one.U, 0.0) << one.symbol;
    EXPECT_LT(std::abs(one.value - exact.report.values[k].value), 2.0 * one.U) << one.symbol;
  }
}

// ---- ISO 230-7

// Component errors of a table turn with it. Seen from the bed, EXC = a cos 3c is a / 2 (cos 4c +
// cos 2c) along X, whose range is 25 / 16 a, and a / 2 (sin 4c - sin 2c) along Y.
TEST(TableErrorMotion, OfARadialErrorGivesItInFixedDirections) {
  const double a = 8.0 * um;
  const TestResult result = tested(
      "EXC = { harmonic = { amplitude_um = 8.0, period_deg = 120, phase_deg = 90 } }", kTable);
  EXPECT_NEAR(value(result, "radial_x_synchronous"), 25.0 / 16.0 * a, 2 * kNothing);
  EXPECT_NEAR(value(result, "radial_x2_synchronous"), 25.0 / 16.0 * a, 2 * kNothing);
  EXPECT_NEAR(value(result, "radial_rotating_synchronous"), 2.0 * a, 2 * kNothing);
  EXPECT_NEAR(value(result, "radial_x_asynchronous"), 0.0, kNothing);
  EXPECT_NEAR(value(result, "axial_total"), 0.0, kNothing);
  EXPECT_NEAR(value(result, "tilt_x_total"), 0.0, 1e-8);
  ASSERT_TRUE(result.sensors);
  ASSERT_EQ(result.sensors->turns.size(), 2U);
  const TurnReadings& turn = result.sensors->turns[1];
  const double theta0 = turn.angles[0];
  for (std::size_t i = 0; i < turn.angles.size(); ++i) {
    const double c = -turn.angles[i];  // the table turns against the sense of the tool
    const auto x = [&](double at) { return -a * std::cos(3 * at) * std::cos(at); };
    const auto y = [&](double at) { return a * std::cos(3 * at) * std::sin(at); };
    EXPECT_NEAR(turn.values[0][i], x(c) - x(theta0), 2 * kNothing) << i;
    EXPECT_NEAR(turn.values[1][i], y(c) - y(theta0), 2 * kNothing) << i;
  }
}

TEST(TableErrorMotion, OfAnAxialErrorGivesItsFundamentalAndTheResidual) {
  const TestResult result = tested(
      "EZC = { harmonic = [{ amplitude_um = 3.0, period_deg = 360 }, { amplitude_um = 1.0, "
      "period_deg = 90 }] }",
      kTable);
  EXPECT_NEAR(value(result, "axial_fundamental"), 6.0 * um, kNothing);
  EXPECT_NEAR(value(result, "axial_residual"), 2.0 * um, kNothing);
  EXPECT_NEAR(value(result, "radial_x_total"), 0.0, kNothing);
}

// EBC = a cos 3c tilts the axis in the table; seen from the bed as the radial error above.
TEST(TableErrorMotion, OfATiltGivesItBetweenBothBalls) {
  const TestResult result = tested(
      "EBC = { harmonic = { amplitude_urad = 30.0, period_deg = 120, phase_deg = 90 } }", kTable);
  EXPECT_NEAR(value(result, "tilt_x_synchronous"), 25.0 / 16.0 * 30 * urad, 1e-8);
  // the first ball is 50 mm above the centre to which the error belongs
  EXPECT_NEAR(value(result, "radial_x_synchronous"), 25.0 / 16.0 * 30 * urad * 50 * mm,
              2 * kNothing);
}

// An axis that is elsewhere, or inclined, moves the balls once a revolution: no error motion.
TEST(TableErrorMotion, DoesNotSeeWhereTheAxisIs) {
  const TestResult result = tested(
      "EX0C = \"20 um\"\nEY0C = \"-10 um\"\nEA0C = \"30 urad\"\nEB0C = \"-20 urad\"", kTable);
  for (const char* const symbol : {"radial_x_total", "radial_y_total", "axial_total"}) {
    EXPECT_NEAR(value(result, symbol), 0.0, 5 * kNothing) << symbol;
  }
  EXPECT_NEAR(value(result, "tilt_y_total"), 0.0, 1e-8);
}

// ---- ISO 10791-6

// An axis that is e along X from where TCP control has it: the TCP deviates by e (1 - cos c) away
// from the axis and by -e sin c along the tangent.
TEST(BallAboutAxis, OfAnOffsetGivesTwiceItsSize) {
  const double e = 10.0 * um;
  const TestResult result = tested("EX0C = \"10 um\"", kBall);
  EXPECT_NEAR(value(result, "radial"), 2 * e, 5 * kNothing);
  EXPECT_NEAR(value(result, "tangential"), 2 * e, 5 * kNothing);
  EXPECT_NEAR(value(result, "axial"), 0.0, kNothing);
  ASSERT_TRUE(result.sensors);
  for (const TurnReadings& turn : result.sensors->turns) {
    ASSERT_EQ(turn.angles.size(), 361U);
    for (std::size_t i = 0; i < turn.angles.size(); ++i) {
      EXPECT_NEAR(turn.values[0][i], e * (1.0 - std::cos(turn.angles[i])), 5 * kNothing) << i;
      EXPECT_NEAR(turn.values[1][i], -e * std::sin(turn.angles[i]), 5 * kNothing) << i;
    }
  }
  EXPECT_EQ(result.sensors->turns[1].name, "backward");
  EXPECT_NEAR(result.sensors->turns[1].angles[0], 360 * deg, 1e-12);
}

TEST(BallAboutAxis, OfComponentErrorsGivesTheirRangeInTheirDirection) {
  const std::string wave = " = { harmonic = { amplitude_um = 4.0, period_deg = 360 } }";
  const std::string turned = " = { harmonic = { amplitude_urad = 40.0, period_deg = 360 } }";
  // read while the axis turns: the planned tip is off its place by nanometres
  EXPECT_NEAR(value(tested("EXC" + wave, kBall), "radial"), 8.0 * um, 2 * kNothing);
  EXPECT_NEAR(value(tested("EYC" + wave, kBall), "tangential"), 8.0 * um, kNothing);
  EXPECT_NEAR(value(tested("EZC" + wave, kBall), "axial"), 8.0 * um, kNothing);
  EXPECT_NEAR(value(tested("ECC" + turned, kBall), "tangential"), 80 * urad * kArm, kNothing);
  EXPECT_NEAR(value(tested("EBC" + turned, kBall), "axial"), 80 * urad * kArm, kNothing);
}

TEST(BallAboutAxis, OfALostMotionGivesItBetweenBothDirections) {
  const TestResult result =
      tested("ECC = { reversal = { width_urad = 20.0, distance_deg = 1.0 } }", kBall);
  EXPECT_NEAR(value(result, "tangential"), 20 * urad * kArm, kNothing);
  EXPECT_NEAR(value(result, "tangential_forward"), 0.0, kNothing);
}

// ---- files, strategies, remarks

std::string written(const TestResult& result) {
  const ReadingsFile file = readings_files(result).at(0);
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / file.name;
  std::ofstream(path) << file.text;
  return path.string();
}

void expect_same_values(const standards::Report& a, const standards::Report& b) {
  constexpr double kPrinted = 5e-12;  // m, of sums of readings that are printed to 1 pm
  ASSERT_EQ(a.values.size(), b.values.size());
  for (std::size_t k = 0; k < a.values.size(); ++k) {
    const bool is_angle = a.values[k].dimension == standards::Dimension::angle;
    EXPECT_EQ(a.values[k].symbol, b.values[k].symbol);
    EXPECT_NEAR(a.values[k].value, b.values[k].value, is_angle ? 10 * kPrinted / 0.1 : kPrinted)
        << a.values[k].symbol;
  }
}

const std::string kSensors =
    "seed = 3\n[test.device]\nresolution_um = 0.1\nvariation_um = 0.4\ndrift_um = 0.2\n";
const std::string kErrors =
    "ECC = { polynomial_urad = [0.0, 0.1], reversal = { width_urad = 5.0, distance_deg = 0.1 } }\n"
    "EXC = { harmonic = { amplitude_um = 3.0, period_deg = 90 } }\nEA0C = \"20 urad\"";

TEST(RotaryTests, GiveTheSameSheetThroughTheReadersOfFiles) {
  const std::string cascade = "servo = \"cascade\"\n";
  const TestResult table = tested(kErrors, kTable + kSensors, cascade);
  expect_same_values(table.report,
                     standards::rotation_report(standards::read_rotation(written(table), 0.1)));
  const TestResult ball = tested(kErrors, kBall + kSensors, cascade);
  expect_same_values(ball.report, standards::ball_report(standards::read_ball(written(ball))));
  const TestResult targets = tested(kErrors, kTargets + kAutocollimator, cascade);
  const auto positions = standards::read_positioning(written(targets));
  EXPECT_TRUE(positions.test.angular);
  EXPECT_LT((positions.test.up - targets.lines[0].test.up).abs().maxCoeff(), 1e-12);
  EXPECT_LT((positions.test.down - targets.lines[0].test.down).abs().maxCoeff(), 1e-12);
}

// A corrected program stops where the errors of the TCP cancel: the linear axes displace it, the
// rotation stays.
TEST(RotaryTests, ReadRewrittenPrograms) {
  const std::string gcode =
      "servo = \"ideal\"\n[[case.strategy]]\ntype = \"gcode\"\naction = \"compensate\"\nmodel = "
      "\"actual\"\n";
  const TestResult ball = tested("EX0C = \"10 um\"\nEA0C = \"30 urad\"", kBall, gcode);
  EXPECT_LT(value(ball, "radial"), 0.1 * um);
  EXPECT_LT(value(ball, "axial"), 0.1 * um);
  const TestResult targets = tested("ECC = { polynomial_urad = [0.0, 0.5] }", kTargets, gcode);
  EXPECT_EQ(targets.lines.at(0).test.targets.size(), 5);
}

TEST(RotaryTests, NoteTheReachedFeed) {
  std::string fast = kBall;
  fast.replace(fast.find("10 rpm"), 6, "190 rpm");
  fast.replace(fast.find("361"), 3, "73");
  const TestResult result = tested("EX0C = \"10 um\"", fast);
  ASSERT_EQ(result.report.remarks.size(), 1U);
  EXPECT_EQ(result.report.remarks[0].find("the programmed feed of 68400 deg/min is not reached: "),
            0U)
      << result.report.remarks[0];
  EXPECT_TRUE(tested("EX0C = \"10 um\"", kBall).report.remarks.empty());
}

std::string refusal(const std::string& test, const std::string& from = "",
                    const std::string& to = "") {
  std::string text = test;
  if (!from.empty()) text.replace(text.find(from), from.size(), to);
  try {
    scenario_of("EX0C = \"10 um\"", text, "");
  } catch (const InputError& error) {
    const std::string what = error.what();
    return what.substr(what.find("error: ") + 7);
  }
  return "read";
}

TEST(RotaryTests, AreRefusedWithTheRule) {
  EXPECT_EQ(refusal(kTable), "read");
  EXPECT_EQ(refusal(kBall), "read");
  EXPECT_EQ(refusal(kTable, "axis = \"C\"", "axis = \"X\""),
            "test[0].axis = \"X\"; must be a rotary axis of the machine, which has B, C");
  EXPECT_EQ(
      refusal(kTable, "X_mm = 0", "X_mm = 12"),
      "test table: the ball is 12 mm off the axis of C, which is at X = 0, Y = 0, Z = 50 mm; at "
      "must be on it");
  EXPECT_EQ(refusal(kTable, "X_mm = 0, ", ""),
            "test[0].at: X_mm is missing: the position of the ball");
  EXPECT_EQ(refusal(kBall, "X_mm = 90", "X_mm = 0"),
            "test ball: the ball is on the axis of C: radial and tangential directions need a "
            "distance of 1 mm at least");
  EXPECT_EQ(refusal(kBall, "X_mm = 90, ", ""),
            "test[0].at: X_mm is missing: the position of the ball");
  EXPECT_EQ(refusal(kBall, "X_mm = 90", "X_mm = 390").substr(0, 36),
            "test ball moves Y from -390 to 390 m");
  EXPECT_EQ(refusal(kBall, "10 rpm", "300 rpm"),
            "test ball moves C at 108000 deg/min; its v_max is 72000 deg/min");
  EXPECT_EQ(refusal(kBall, "rotary_feed = \"10 rpm\"", "rotary_feed = \"10 rpm\"\nfeed = 1.0"),
            "test[0].feed = 1.0; has no effect on a test after iso10791-6");
  EXPECT_EQ(refusal(kTargets, "runs = 2", "runs = 2\noverrun_mm = 2"),
            "test[0].overrun_mm = 2; has no effect on a test after iso230-2 of a rotary axis");
  EXPECT_EQ(refusal(kBall + "[test.device]\nset_up_um = 1.0\n"),
            "test[0].device.set_up_um = 1.0; has no effect on sensors about a rotary axis");
  EXPECT_EQ(refusal(kTargets + "[test.device]\nmisalignment_mrad = 1.0\n"),
            "test[0].device.misalignment_mrad = 1.0; has no effect on positions of a rotary axis");
}

}  // namespace
}  // namespace servomill::sim::run::rotary_tests_test

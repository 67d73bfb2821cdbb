/// A run reports where saturations act and tables end.
#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"
#include "sim/engine/simulate.h"
#include "sim/model/scenario.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/prepare_cases.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::limit_warnings_test {
namespace {

// Y is 1 um off for each mm of X: 60 um at the end of line 3, 20 um and less in line 4.
constexpr const char* kProgram =
    "G17 G21 G40 G90 G94\nG1 X-10 F6000\nG1 X60\nG1 X20\nG1 X-20\nG0 X150\nG1 X0\nM30\n";
const std::string kErrors =
    "imposed = \"machine\"\n[errors.machine]\nEYX = { polynomial_um = [0.0, 1.0] }\n";

std::string one_case(const std::string& name, const std::string& strategy,
                     const std::string& more = "") {
  return "[[case]]\nname = \"" + name + "\"\n" + more +
         "[[case.strategy]]\nmodel = \"machine\"\naction = \"impose\"\n" + strategy;
}

std::string note_of(const CaseOutput& output) {
  return output.notes.empty() ? "none" : output.notes.front();
}

TEST(Spindle, OfUnknownAccelerationIsTold) {
  const auto note = [](const std::string& spindle) {
    const model::Scenario scenario = small_scenario("G21 S1000 M3\nG0 Z1\nG33.1 Z-2 K1\nM2\n",
                                                    "[[case]]\nname = \"one\"\n" + spindle);
    return note_of(run_named_case(scenario, "one"));
  };
  EXPECT_EQ(note("[machine_override.nc.spindle]\nacceleration_rpm_per_s = 5000.0\n"), "none");
  EXPECT_EQ(note(""),
            "small.ngc:3: warning: the acceleration of the spindle is unknown: synchronised motion "
            "is planned with the limits of the axes only; set nc.spindle.acceleration_rpm_per_s of "
            "the machine");
}

// From X50 to X60 and back to X50 at 100 mm/s, and at X150 to X50 again, less what lag and ramps
// do.
TEST(Saturation, IsToldWithItsLimitLineAndTime) {
  const std::string feedback = "type = \"feedback\"\n";
  const model::Scenario scenario = small_scenario(
      kProgram, kErrors + one_case("free", feedback) +
                    one_case("size", feedback + "max_um = 50.0\n") +
                    one_case("rate", feedback + "max_rate_mm_per_s = 0.09\n") +
                    one_case("ideal", feedback + "max_um = 50.0\n", "servo = \"ideal\"\n"));
  EXPECT_EQ(note_of(run_named_case(scenario, "free")), "none");
  const CaseOutput size = run_named_case(scenario, "size");
  ASSERT_EQ(size.notes.size(), 1U);
  EXPECT_NE(size.notes[0].find("small.ngc:3: warning: case size: strategy feedback: virtual "
                               "displacement of Y saturated at 50 um, first here, "),
            std::string::npos)
      << size.notes[0];
  // how long, from the recorded place of X
  const auto beyond = [](const CaseOutput& one, const char* what) {
    const records::Series& servo = one.result.servo;
    double rows = 0.0;
    for (std::size_t n = 0; n < servo.rows(); ++n) {
      if (servo.at(n, servo.column(what, 'X').value()) > 50.0) rows += 1.0;
    }
    return rows * 1 * ms;
  };
  constexpr double kRows = 6 * ms;  // of 1 ms, where it begins and ends
  ASSERT_EQ(size.result.saturations.size(), 1U);
  EXPECT_NEAR(size.result.saturations[0].time, beyond(size, "meas_linear"), kRows);
  const CaseOutput ideal = run_named_case(scenario, "ideal");
  ASSERT_EQ(ideal.result.saturations.size(), 1U);
  EXPECT_NEAR(ideal.result.saturations[0].time, beyond(ideal, "true_linear"), kRows);
  EXPECT_NE(note_of(run_named_case(scenario, "rate"))
                .find(": strategy feedback: rate of the virtual displacement of Y saturated at "
                      "0.09 mm/s, first here, "),
            std::string::npos)
      << note_of(run_named_case(scenario, "rate"));
}

// Runs in lockstep tell the same.
TEST(Saturation, IsTheSameInLockstep) {
  const std::string feedback = "type = \"feedback\"\nmax_um = 50.0\n";
  const model::Scenario scenario = small_scenario(kProgram, kErrors + one_case("a", feedback) +
                                                                one_case("b", feedback,
                                                                         "work_offset = { "
                                                                         "X_mm = 7.0 }\n"));
  preparation::PreparationCache cache;
  const std::vector<preparation::PreparedCase> cases = preparation::prepare_cases(scenario, &cache);
  std::vector<engine::CaseInputs> inputs;
  for (const preparation::PreparedCase& one : cases) inputs.push_back(one.inputs());
  std::vector<engine::CaseInputs*> together;
  for (engine::CaseInputs& one : inputs) together.push_back(&one);
  const engine::StopFlag never = false;
  std::atomic<float> progress = 0.0F;
  const auto results = engine::simulate(together, never, progress);
  for (std::size_t k = 0; k < cases.size(); ++k) {
    const CaseOutput alone = run_named_case(scenario, cases[k].spec().name);
    ASSERT_EQ(alone.result.saturations.size(), 1U);
    ASSERT_EQ(results[k].saturations.size(), 1U);
    EXPECT_EQ(results[k].saturations[0].first, alone.result.saturations[0].first);
    EXPECT_EQ(results[k].saturations[0].time, alone.result.saturations[0].time);
  }
}

// The rapid move to X150 cuts nothing, the way back begins beyond the table.
TEST(EndOfATable, IsToldWhereTheProgramGoesOn) {
  const std::string table =
      "type = \"table\"\nbase_axis = \"X\"\nspacing_rule = \"free\"\nspacing_mm = 10.0\n";
  const model::Scenario scenario =
      small_scenario(kProgram, kErrors + one_case("wide", table) +
                                   one_case("short", table + "from_mm = -20.0\nto_mm = 55.0\n") +
                                   one_case("both", table + "from_mm = -15.0\nto_mm = 155.0\n"));
  EXPECT_EQ(note_of(run_named_case(scenario, "wide")), "none");
  const CaseOutput one = run_named_case(scenario, "short");
  // points every 10 mm: the last one at 60. At its end the offset changes at once
  ASSERT_EQ(one.notes.size(), 2U);
  EXPECT_NE(one.notes[0].find("case short: path and offset together exceed limits: "),
            std::string::npos);
  EXPECT_TRUE(one.notes[1].ends_with(
      "small.ngc:7: warning: case short: strategy table: the table over X ends at 60.0000 mm, the "
      "program continues to 150.0000 mm; beyond the end the last value is used"))
      << one.notes[1];
  const CaseOutput both = run_named_case(scenario, "both");
  EXPECT_TRUE(both.notes.back().ends_with(
      "small.ngc:5: warning: case both: strategy table: the table over X ends at -15.0000 "
      "mm, the program continues to -20.0000 mm; beyond the end the last value is used"))
      << both.notes.back();
}

// EYX = 1 um/mm: 7 mm away Y is wrong by 7 um everywhere.
TEST(RewrittenProgram, KeepsTheErrorsOfThePlaceThatItWasRewrittenFor) {
  const std::string gcode = "type = \"gcode\"\n", moved = "work_offset = { X_mm = 7.0 }\n",
                    ideal = "servo = \"ideal\"\n";
  const model::Scenario scenario = small_scenario(
      kProgram, kErrors + one_case("here", gcode, ideal) + one_case("moved", gcode, ideal + moved) +
                    one_case("old", gcode + "rewrite_origin = \"program\"\n", ideal + moved) +
                    one_case("unmoved", gcode + "rewrite_origin = \"program\"\n", ideal));
  // largest distance of Y from the error curve of a place `shift` mm away
  const auto off = [&](const char* name, double shift) {
    const records::Series servo = run_named_case(scenario, name).result.servo;
    const std::size_t x = *servo.column("ref_linear", 'X'), y = *servo.column("true_linear", 'Y');
    const std::size_t line = *servo.column("line");
    double largest = 0.0;
    for (const std::size_t n : rows_within(servo, 0.0, 50.0)) {
      if (servo.at(n, line) < 3.0) continue;  // begins where the machine stands, undisplaced
      largest = std::max(largest, std::abs(servo.at(n, y) - 1e-3 * (servo.at(n, x) - shift)));
    }
    return largest;
  };
  constexpr double kPrinted = 1e-5;  // mm, of printed programs and of corners that are passed
  EXPECT_LT(off("here", 0.0), kPrinted);
  EXPECT_LT(off("moved", 0.0), kPrinted);
  EXPECT_LT(off("unmoved", 0.0), kPrinted);
  EXPECT_LT(off("old", 7.0), kPrinted);
}

// The cubic through 0, 0, 10, 10 um goes 2.5 um beyond them.
TEST(Overshoot, OfACubicGridIsReportedWithItsPlace) {
  const auto notes = [](const std::string& interpolation) {
    const std::string grid =
        "machine_errors = \"machine\"\n[errors.machine]\nEYX = { grid = { axes = \"X\", at_mm = "
        "[[-400, -200, 0, 400]], value_um = [0, 0, 10, 10], interpolation = \"" +
        interpolation + "\" } }\n";
    const model::Scenario scenario = small_scenario(
        "G21 G1 X10 F6000\nM30\n",
        grid + "[[case]]\nname = \"one\"\nservo = \"ideal\"\n[[case]]\nname = \"two\"\n");
    return run_named_case(scenario, "one").notes;
  };
  EXPECT_TRUE(notes("linear").empty());
  const auto found = notes("cubic");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].find("warning: errors.machine.EYX: at X = "), 0U) << found[0];
  EXPECT_NE(found[0].find(" um beyond its values at X = 0 and 400 mm; add positions there, or use "
                          "interpolation = \"linear\""),
            std::string::npos)
      << found[0];
}

}  // namespace
}  // namespace servomill::sim::run::limit_warnings_test

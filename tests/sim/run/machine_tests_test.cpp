/// Positioning tests that a run makes: closed forms, the device, and the same sheet from the file.
#include "sim/run/machine_tests.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "sim/run/test_sheet.h"
#include "sim/standards/positioning_readings.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::machine_tests_test {
namespace {

using standards::Positioning;

const std::string kTest =
    "[[test]]\nname = \"X\"\nstandard = \"iso230-2\"\naxis = \"X\"\ntargets_mm = [-40, -15, 3, 20, "
    "45]\nruns = 2\nfeed = \"6 m/min\"\ndwell_s = 0.2\n";
const std::string kIdeal = "servo = \"ideal\"\n";
const std::string kCase = "[[case]]\nname = \"ideal\"\n";

model::Scenario machine_under_test(const std::string& errors, const std::string& more = "",
                                   const std::string& servo = kIdeal) {
  return input::read_resolved_scenario(
      "machine = \"machines/hsm600u.toml\"\n"
      "machine_errors = \"actual\"\n[errors.actual]\n" +
          errors + "\n" + kTest + more + kCase + servo,
      SERVOMILL_SOURCE_DIR "/scenarios/small.toml");
}

TestResult tested(const std::string& errors, const std::string& more = "",
                  const std::string& servo = kIdeal) {
  return *run_named_case(machine_under_test(errors, more, servo), "ideal").tests.at(0);
}

double value(const TestResult& result, Positioning which) {
  return result.report.values[static_cast<std::size_t>(which)].value;
}

constexpr double kRounding = 1e-12;  // m: the signals are recorded in steps of 1 pm

TEST(MachineTest, OfAScaleErrorGivesItsSizeOverTheTravelAndNothingElse) {
  const TestResult result = tested("EXX = { um_per_m = 100.0 }");
  const double error = 100e-6 * 85.0 * mm;
  for (const Positioning which :
       {Positioning::E, Positioning::E_up, Positioning::M, Positioning::A, Positioning::A_down}) {
    EXPECT_NEAR(value(result, which), error, 10 * kRounding);
  }
  for (const Positioning which : {Positioning::B, Positioning::R, Positioning::R_up}) {
    EXPECT_NEAR(value(result, which), 0.0, 10 * kRounding);
  }
}

// Lost motion of 6 um: +3 um at targets approached from below, -3 um from above.
TEST(MachineTest, OfALostMotionGivesItsWidthAsReversalError) {
  const TestResult result = tested("EXX = { reversal = { width_um = 6.0, distance_mm = 0.1 } }");
  EXPECT_NEAR(std::abs(value(result, Positioning::B)), 6.0 * um, 10 * kRounding);
  EXPECT_NEAR(std::abs(value(result, Positioning::B_mean)), 6.0 * um, 10 * kRounding);
  EXPECT_NEAR(value(result, Positioning::R), 6.0 * um, 20 * kRounding);
  EXPECT_NEAR(value(result, Positioning::R_up), 0.0, 20 * kRounding);
  EXPECT_NEAR(value(result, Positioning::M), 0.0, 10 * kRounding);
  EXPECT_NEAR(value(result, Positioning::E), 6.0 * um, 10 * kRounding);
}

// Abbe: the TCP moves by pitch times its height; the tool that brings it there does not matter.
TEST(MachineTest, MeasuresAtTheTcpWhereTheOtherAxesAre) {
  const std::string pitch = "EBX = { polynomial_urad = [0.0, 0.5] }";  // urad/mm
  const std::string tool = "tool = 1\n[[program.tool]]\nnumber = 1\nlength_mm = 100.0\n";
  const double low = value(tested(pitch), Positioning::E);
  const double high = value(tested(pitch, "at = { Z_mm = 100.0 }\n"), Positioning::E);
  EXPECT_NEAR(std::abs(high - low), 0.5e-6 * 85.0 * 100.0 * mm, 1 * nm);
  EXPECT_NEAR(value(tested(pitch, tool), Positioning::E), low, 1 * nm);
}

// Neither a work offset nor a rotated table changes where the axis is bad: with C at 90 degrees the
// TCP moves along Y of the workpiece.
TEST(MachineTest, FollowsWorkOffsetAndRotaryAxes) {
  const std::string errors = "EXX = { um_per_m = 100.0 }";
  for (const std::string more :
       {"[program.work_offset]\nX_mm = 30.0\nY_mm = -20.0\n", "at = { C_deg = 90.0 }\n"}) {
    const TestResult result = tested(errors, more);
    EXPECT_NEAR(value(result, Positioning::E), 100e-6 * 85.0 * mm, 1 * nm) << more;
    EXPECT_NEAR(result.lines[0].test.up(4, 0), 100e-6 * 85.0 * mm, 1 * nm) << more;
  }
}

// A program that a strategy has rewritten stops where the errors cancel, up to their square.
TEST(MachineTest, ReadsRewrittenPrograms) {
  const TestResult result =
      tested("EXX = { um_per_m = 1000.0 }", "",
             kIdeal +
                 "[[case.strategy]]\ntype = \"gcode\"\naction = \"compensate\"\nmodel = "
                 "\"actual\"\n");
  EXPECT_NEAR(value(result, Positioning::E), 1e-3 * 1e-3 * 85.0 * mm, 2 * nm);
}

TEST(MachineTest, ReadsTheNoseAfterATool) {
  std::string nose = kTest;
  nose.replace(nose.find("\"X\""), 3, "\"nose\"");
  const model::Scenario scenario =
      machine_under_test("EXX = { um_per_m = 100.0 }",
                         "tool = 1\n" + nose + "[[program.tool]]\nnumber = 1\nlength_mm = 100.0\n");
  const std::string program = scenario.program.text();
  EXPECT_NE(program.find("(MSG, nose)\nG49\nT0 M6\n"), std::string::npos);
  EXPECT_EQ(run_named_case(scenario, "ideal").tests.size(), 2U);
}

TEST(NoteOfCreep, SaysThatTheAxisStillMovedWhenItWasRead) {
  TestResult result;
  result.name = "X";
  result.creep = 0.01 * um;
  EXPECT_EQ(note_of_creep(result, 0.1), std::nullopt);
  result.creep = 0.4 * um;
  EXPECT_EQ(note_of_creep(result, 0.1),
            "test X: the axis still moved by up to 0.4 um during the reading, which counts as its "
            "error; increase dwell_s above 0.1");
  EXPECT_LT(tested("EXX = { um_per_m = 100.0 }").creep, 20 * kRounding);
  EXPECT_GT(tested("EXX = { um_per_m = 100.0 }", "", "servo = \"cascade\"\n").creep, 1 * nm);
}

// Studies of convergence carry quantities; what they leave out is named.
TEST(NoteOfMissingTests, NamesWhatACommandLeavesOut) {
  const model::Scenario scenario = machine_under_test("EXX = { um_per_m = 100.0 }");
  EXPECT_THROW(note_of_missing_tests(scenario, "converge"), InputError);
  model::Scenario with_quantity = scenario;
  with_quantity.quantities.emplace_back();
  EXPECT_EQ(
      note_of_missing_tests(with_quantity, "converge"),
      "servomill converge carries quantities; parameters of [[test]] are printed and stored by "
      "servomill run and sweep only");
  with_quantity.tests.clear();
  EXPECT_EQ(note_of_missing_tests(with_quantity, "converge"), std::nullopt);
}

TEST(RemarksOf, NamesTheCasesOfWhatDoesNotHoldForAll) {
  TestResult one, other;
  one.report.remarks = {"common", "own"};
  other.report.remarks = {"common"};
  EXPECT_EQ(remarks_of({"a", "b"}, {&one, &other}), (std::vector<std::string>{"common", "a: own"}));
}

const std::string kDevice =
    "seed = 7\n[test.device]\nresolution_um = 0.1\nvariation_um = 1.0\nscale_uncertainty_um_per_m "
    "= "
    "2.0\n";

TEST(MachineTest, ReadsADeviceWhoseErrorsFollowFromItsSeed) {
  const std::string errors = "EXX = { um_per_m = 100.0 }";
  const TestResult once = tested(errors, kDevice), again = tested(errors, kDevice);
  EXPECT_TRUE((once.lines[0].test.up == again.lines[0].test.up).all());
  std::string other = kDevice;
  other.replace(other.find('7'), 1, "8");
  EXPECT_FALSE((once.lines[0].test.up == tested(errors, other).lines[0].test.up).all());
  // rectangular parts of +-0.5 um and +-0.05 um, and a scale of 2 um/m, four times at the most
  const Eigen::ArrayXd true_deviation =
      100e-6 * (once.lines[0].test.targets - once.lines[0].test.targets[0]);
  const Eigen::ArrayXXd off = once.lines[0].test.up.colwise() - true_deviation;
  EXPECT_LT(off.abs().maxCoeff(), 0.55 * um + 4.0 * 2e-6 * 85.0 * mm);
  EXPECT_GT(off.abs().maxCoeff(), 0.05 * um);
}

TEST(MachineTest, StatesTheUncertaintyOfItsDevice) {
  const TestResult result = tested("EXX = { um_per_m = 100.0 }", kDevice);
  const std::size_t B = static_cast<std::size_t>(Positioning::B);
  EXPECT_GT(result.report.values[B].U, 0.1 * um);
  EXPECT_TRUE(std::isnan(result.report.values[static_cast<std::size_t>(Positioning::E)].U));
  EXPECT_TRUE(std::any_of(result.report.remarks.begin(), result.report.remarks.end(),
                          [](const std::string& one) {
                            return one.find("cannot be stated without") != std::string::npos;
                          }));
}

TEST(ReadingsCsv, GiveTheSameSheetThroughTheReaderOfFiles) {
  const TestResult result = tested("EXX = { um_per_m = 100.0 }", kDevice);
  const std::string path = testing::TempDir() + "/readings_of_a_run.csv";
  std::ofstream(path) << readings_files(result).at(0).text;
  const standards::PositioningFile file = standards::read_positioning(path);
  std::filesystem::remove(path);
  constexpr double kPrinted = 1e-12;  // m, half of the last digit, of sums of some
  EXPECT_LT((file.test.targets - result.lines[0].test.targets).abs().maxCoeff(), 1e-9);
  EXPECT_LT((file.test.up - result.lines[0].test.up).abs().maxCoeff(), kPrinted);
  EXPECT_LT((file.test.down - result.lines[0].test.down).abs().maxCoeff(), kPrinted);
}

std::string refusal(const std::string& test) {
  try {
    input::read_resolved_scenario("machine = \"machines/hsm600u.toml\"\n" + test + kCase,
                                  SERVOMILL_SOURCE_DIR "/scenarios/small.toml");
  } catch (const InputError& error) {
    const std::string text = error.what();
    return text.substr(text.find("error: ") + 7);
  }
  return "read";
}

std::string changed(const std::string& from, const std::string& to) {
  std::string out = kTest;
  return out.replace(out.find(from), from.size(), to);
}

// One fault an axis, not one a block; the length of the tool counts.
TEST(MachineTest, IsRefusedWhereAnAxisWouldLeaveItsTravel) {
  EXPECT_EQ(refusal(kTest + "at = { Y_mm = 5000.0 }\n"),
            "test X is run at Y = 5000 mm, in machine coordinates; the travel is -300 to 300 mm");
  const std::string tool = "tool = 1\n[[program.tool]]\nnumber = 1\nlength_mm = 5000.0\n";
  EXPECT_EQ(refusal(kTest + tool).substr(0, 27), "test X is run at Z = 5000 m");
}

TEST(MachineTest, IsRefusedWithTheRule) {
  EXPECT_EQ(refusal(kTest), "read");
  EXPECT_EQ(refusal(changed("axis = \"X\"", "axis = \"A\"")),
            "test[0].axis = \"A\"; must be an axis of the machine, which has X, Y, Z, B, C");
  EXPECT_EQ(refusal(changed("6 m/min", "600 m/min")),
            "test X moves X at 600000 mm/min; its v_max is 40000 mm/min");
  EXPECT_EQ(refusal(changed("-40", "-4000")),
            "test X moves X from -4001 to 46 mm with its overrun, in machine coordinates; the "
            "travel is -400 to 400 mm");
  EXPECT_EQ(refusal(changed("[-40, -15", "[-15, -40")),
            "test[0].targets_mm = [-15, -40, 3, 20, 45]; must be two targets or more in rising "
            "order");
  EXPECT_EQ(refusal(kTest + "from_mm = 1.0\n"),
            "test[0].from_mm = 1.0; has no effect with targets_mm");
  EXPECT_EQ(
      refusal(changed("\"X\"", "\"a (b)\"")),
      "test[0].name = \"a (b)\"; must not contain ( ) / or line breaks: it names a section of "
      "the program");
  EXPECT_EQ(refusal(kTest + "[record]\nperiod_ms = 25.0\n"),
            "record: period_ms must be at most 20 ms, a tenth of the dwell of test X");
  EXPECT_EQ(refusal(kTest + "at = { X_mm = 1.0 }\n"),
            "test[0].at.X_mm = 1.0; is the axis under test");
  EXPECT_EQ(refusal(kTest + "[program]\nfile = \"a.ngc\"\n"),
            "program.file = \"a.ngc\"; has no effect: [[test]] writes the program");
  EXPECT_EQ(refusal(kTest + "[program]\ntext = \"M2\"\n"),
            "program.text = \"M2\"; has no effect: [[test]] writes the program");
  EXPECT_EQ(refusal(changed("\"X\"", "\"X \"")),
            "test[0].name = \"X \"; must not begin or end with blanks");
  EXPECT_EQ(refusal(changed("\"X\"", "\".\"")),
            "test[0].name = \".\"; must not be . or ..: it names a group of the result file");
  EXPECT_EQ(refusal(kTest + "[program]\nreader = \"heidenhain\"\n"),
            "program.reader = \"heidenhain\"; must read G-code, which [[test]] makes");
}

}  // namespace
}  // namespace servomill::sim::run::machine_tests_test

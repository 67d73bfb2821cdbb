/// Error models that differ from others: identified models with stated identification errors.
#include <gtest/gtest.h>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"
#include "tests/text.h"

namespace servomill::sim::run::error_models_test {
namespace {

using plant::operator""_err;

constexpr double kRounding = 1e-18;  // m, rad, of sums of some 1e-5

model::Scenario with_errors(const std::string& errors) {
  return small_scenario("M2\n", errors + "[[case]]\nname = \"one\"\n");
}

std::string faults_of(const std::string& errors) {
  return fault_messages([&] { with_errors(errors); });
}

const std::string kMachine =
    "[errors.machine]\nEX0C = \"8 um\"\nEA0C = \"25 urad\"\nEC0Y = { um_per_m = 15.0 }\n"
    "EYX = { polynomial_um = [1.0, 0.5] }\n";

TEST(ErrorModels, DifferByWhatTheySay) {
  const model::Scenario scenario = with_errors(
      "[errors.identified]\nrelative_to = \"machine\"\nEX0C = \"-0.5 um\"\nEA0C = { constant_urad "
      "= "
      "2.0 }\nEB0C = \"3 urad\"\nEYX = { constant_um = 0.25 }\nEZX = { constant_um = 4.0 }\n" +
      kMachine);
  const plant::ErrorModel &identified = scenario.errors.at("identified"),
                          &machine = scenario.errors.at("machine");
  EXPECT_NEAR(identified.location("EX0C"_err), 7.5 * um, kRounding);
  EXPECT_NEAR(identified.location("EA0C"_err), 27.0 * urad, kRounding);
  EXPECT_NEAR(identified.location("EB0C"_err), 3.0 * urad, kRounding);
  EXPECT_NEAR(identified.location("EC0Y"_err), 15.0 * urad, kRounding);
  const double x = 10.0 * mm;
  EXPECT_NEAR(identified.component("EYX"_err).value(x), (1.0 + 5.0 + 0.25) * um, kRounding);
  EXPECT_NEAR(identified.component("EZX"_err).value(x), 4.0 * um, kRounding);
  EXPECT_NEAR(machine.location("EX0C"_err), 8.0 * um, kRounding);
  EXPECT_NEAR(machine.component("EYX"_err).value(x), 6.0 * um, kRounding);
}

TEST(ErrorModels, MayHaveAnErrorOfScale) {
  const model::Scenario scenario =
      with_errors("[errors.screw]\nEXX = { um_per_m = 40.0, constant_um = 1.0 }\n");
  const auto& EXX = scenario.errors.at("screw").component("EXX"_err);
  EXPECT_NEAR(EXX.value(0.25), 11.0 * um, kRounding);
  EXPECT_NEAR(EXX.value(-0.5), -19.0 * um, kRounding);
}

// EC0Y = 250 would be 40 turns, EX0C = 8 as many metres.
TEST(ErrorModels, RefuseALocationWhoseUnitWasForgotten) {
  EXPECT_EQ(faults_of("[errors.skew]\nEC0Y = 0.1\n"), "");
  EXPECT_EQ(faults_of("[errors.skew]\nEC0Y = -250.0\nEX0C = 8\n"),
            "errors.skew.EC0Y = -250.0; exceeds 0.1 rad, which is implausible; a number without a "
            "unit is in rad: write \"50 urad\" or { um_per_m = 50.0 }\nerrors.skew.EX0C = 8; "
            "exceeds 0.1 m, which is implausible; a number without a unit is in m: write \"8 um\" "
            "or { constant_um = 8.0 }\n");
}

TEST(ErrorModels, ThatDifferByNothingAreTheSame) {
  const model::Scenario scenario =
      with_errors("[errors.identified]\nrelative_to = \"machine\"\n" + kMachine);
  EXPECT_TRUE(scenario.errors.at("identified") == scenario.errors.at("machine"));
}

TEST(ErrorModels, DifferFromAnotherThatIsComplete) {
  const auto differing = [](const std::string& from) {
    return kMachine + "[errors.identified]\nrelative_to = " + from + "\n";
  };
  EXPECT_EQ(faults_of(differing("\"machine\"")), "");
  EXPECT_EQ(
      faults_of(differing("\"machin\"")),
      "errors.identified.relative_to = \"machin\"; must be the name of another error model; did "
      "you mean 'machine'?\n");
  EXPECT_EQ(
      faults_of(differing("\"identified\"")),
      "errors.identified.relative_to = \"identified\"; must be the name of another error model\n");
  EXPECT_EQ(faults_of(differing("1")), "errors.identified.relative_to = 1; must be a string\n");
  EXPECT_EQ(faults_of(differing("\"other\"") + "[errors.other]\nrelative_to = \"machine\"\n"),
            "errors.identified.relative_to = \"other\"; must name a model that is not itself "
            "relative to another\n");
}

// With an identified model that is off by 2 um along X the tip ends up 2 um off, and nowhere else:
// the C axis has turned half about, so that its place counts twice.
TEST(ErrorModels, LeaveTheirDifferenceWhenTheyAreCompensated) {
  const auto left = [](const std::string& difference) {
    const model::Scenario scenario = small_scenario(
        "G21 G90 G94\nG0 X20 C180\nG1 X30 F1000\nM2\n",
        "machine_errors = \"machine\"\n" + kMachine +
            "[errors.identified]\nrelative_to = \"machine\"\n" + difference +
            "[[case]]\nname = \"one\"\nservo = \"ideal\"\n[[case.strategy]]\ntype = \"feedback\"\n"
            "model = \"identified\"\niterations = \"converged\"\n");
    const CaseOutput out = run_named_case(scenario, "one");
    return largest_of(out.result.servo, "tool_deviation", 'X',
                      rows_within(out.result.servo, 20.0, 30.0));
  };
  constexpr double kTolerance = 1e-3;  // um: the difference times angles of 25 urad, recording
  EXPECT_NEAR(left(""), 0.0, kTolerance);
  EXPECT_NEAR(left("EX0C = \"1 um\"\n"), 2.0, kTolerance);
}

}  // namespace
}  // namespace servomill::sim::run::error_models_test

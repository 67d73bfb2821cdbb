/// Moves of rotary axes alone: they have no arc length, but take their time and turn the workpiece.

#include <gtest/gtest.h>

#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::indexing_test {
namespace {

const std::string kProgram = "G21 G90 G94 G64 P0.001\nG0 X10 Y0\nG1 C30 F300\nG1 X20 F600\nM30\n";

TEST(Indexing, LeavesNoDeviationOnAFaultlessMachine) {
  constexpr double kServoTol = 20.0;  // um, following errors of this program
  const model::Scenario scenario = small_scenario(kProgram, "[[case]]\nname = \"one\"\n");
  const CaseOutput one = run_named_case(scenario, "one");
  const records::Series& series = one.result.servo;
  const std::size_t y = *series.column("tool_deviation", 'Y');
  for (std::size_t row = 0; row < series.rows(); ++row) {
    ASSERT_LT(std::abs(series.at(row, y)), kServoTol) << row;
  }
}

TEST(Indexing, TakesAsLongInARewrittenProgram) {
  const model::Scenario scenario = small_scenario(
      kProgram,
      "[errors.identified]\nEYC = { harmonic = { amplitude_um = 50.0, period_deg = 40.0 } }\n"
      "[[case]]\nname = \"nominal\"\n"
      "[[case]]\nname = \"gcode\"\n[[case.strategy]]\ntype = \"gcode\"\nmodel = \"identified\"\n");
  const double nominal = run_named_case(scenario, "nominal").duration;
  const double rewritten = run_named_case(scenario, "gcode").duration;
  EXPECT_GT(nominal, 6.0);                         // 30 deg at 300 deg/min
  EXPECT_NEAR(rewritten, nominal, 0.1 * nominal);  // blocks may begin and end at rest
}

TEST(Reading, RefusesADelayOfAPositionPeriod) {
  const auto with_delay = [](const char* delay) {
    return small_scenario(kProgram, std::string("[feedback_hardware]\nsignal_delay_us = ") + delay +
                                        "\n[[case]]\nname = \"one\"\n");
  };
  EXPECT_NO_THROW(with_delay("190.0"));
  EXPECT_THROW(with_delay("200.0"), InputError);
}

TEST(Reading, RefusesAnOddTriangle) {
  const auto with_filter = [](const char* length) {
    return small_scenario(kProgram,
                          std::string("[machine_override.nc]\nnominal_filter = \"triangle\"\n"
                                      "nominal_filter_ms = ") +
                              length + "\n[[case]]\nname = \"one\"\n");
  };
  EXPECT_NO_THROW(with_filter("0.8"));
  EXPECT_THROW(with_filter("0.2"), InputError);
  EXPECT_THROW(with_filter("0.6"), InputError);
}

TEST(Table, HasAtLeastOneInterval) {
  const model::Scenario scenario = small_scenario(
      "G21 G90 G94\nG1 X20 F600\nM30\n",
      "[errors.identified]\nEYX = { constant_um = 10.0 }\n"
      "[[case]]\nname = \"table\"\n[[case.strategy]]\ntype = \"table\"\nmodel = \"identified\"\n"
      "action = \"impose\"\nbase_axis = \"X\"\nspacing_rule = \"free\"\nspacing_mm = 1e12\n");
  const CaseOutput one = run_named_case(scenario, "table");
  const records::Series& series = one.result.servo;
  EXPECT_NEAR(series.at(series.rows() - 1, *series.column("cmd_linear", 'Y')), 0.010, 1e-9);
}

TEST(Lead, IsThatOfEachAxis) {
  const model::Scenario scenario = small_scenario(
      "G21 G90 G94 G64 P0.001\nG1 X-100 F1394\n(MSG, cruise)\nG1 X60\n(MSG, out)\nG1 X80\nM30\n",
      "imposed = \"identified\"\n"
      "[machine_override.axis.Y]\nKv = \"30 1/s\"\n"
      "[errors.identified]\nEYX = { harmonic = { amplitude_um = 150.0, period_mm = 62.0 } }\n"
      "[[case]]\nname = \"nominal\"\n"
      "[[case]]\nname = \"lead\"\n[[case.strategy]]\ntype = \"feedback\"\nmodel = \"identified\"\n"
      "action = \"impose\"\nextrapolation_time_ms = \"auto\"\n"
      "[[quantity]]\nname = \"realised_ratio\"\naxis = \"X\"\nbaseline = \"nominal\"\ncases = "
      "[\"lead\"]\n");
  const CaseOutput nominal = run_named_case(scenario, "nominal"),
                   lead = run_named_case(scenario, "lead");
  model::QuantitySpec spec;
  spec.name = "lag_time";
  spec.axis = 'Y';
  spec.cases = {"lead"};
  spec.baseline = "nominal";
  spec.sections = {"cruise"};
  const std::vector<model::QuantitySpec> specs = {spec};
  const std::vector<evaluation::CaseData> data = {nominal.data(), lead.data()};
  EXPECT_NEAR(evaluation::compare(specs, data).front().value, 0.0,
              0.5);  // ms; 1/Kv of Y is 33 ms, of X 17 ms
}

}  // namespace
}  // namespace servomill::sim::run::indexing_test

/// Parameters of tests as rows of a sweep: the same rows before and after a run.
#include "sim/run/test_comparison.h"

#include <gtest/gtest.h>

#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/evaluation/comparison.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "sim/run/machine_tests.h"
#include "sim/run/test_sheet.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::test_comparison_test {
namespace {

std::string test(const std::string& name, const std::string& standard, const std::string& keys) {
  return "[[test]]\nname = \"" + name + "\"\nstandard = \"" + standard + "\"\ndwell_s = 0.1\n" +
         keys + "\n";
}

// One of each standard.
model::Scenario scenario_of_all() {
  const std::string cycle = "runs = 2\nfeed = \"6 m/min\"\n";
  const std::string turn = "axis = \"C\"\nrotary_feed = \"30 rpm\"\nreading_count = 90\n";
  return input::read_resolved_scenario(
      "machine = \"machines/hsm600u.toml\"\nmachine_errors = \"actual\"\n[errors.actual]\nEXX = { "
      "um_per_m = 100.0 }\nEXC = { harmonic = { amplitude_um = 3.0, period_deg = 120 } }\n" +
          test("X", "iso230-2", "axis = \"X\"\ntargets_mm = [-40, 3, 45]\n" + cycle) +
          test("C", "iso230-2",
               "axis = \"C\"\nfrom_deg = 0\nto_deg = 90\nrotary_feed = \"30 rpm\"\nruns = 2\n") +
          test("body", "iso230-6",
               "from = { X_mm = -30, Y_mm = -40 }\nto = { X_mm = 30, Y_mm = 40 }\n" + cycle) +
          test(
              "circle", "iso230-4",
              "plane = \"XY\"\nradius_mm = 20\nfeed = \"1 m/min\"\nat = { X_mm = 0, Y_mm = 0 }\n") +
          test("table", "iso230-7",
               turn + "distance_mm = 100\nat = { X_mm = 0, Y_mm = 0, Z_mm = 50 }\n") +
          test("turns", "iso230-7",
               turn + "revolutions = 2\nat = { X_mm = 0, Y_mm = 0, Z_mm = 50 }\n") +
          test("ball", "iso10791-6",
               turn + "from_deg = 0\nto_deg = 90\ntool = 1\n"
                      "at = { X_mm = 90, Y_mm = 0, Z_mm = 120 }\n") +
          "[[program.tool]]\nnumber = 1\nlength_mm = 100.0\n"
          "[[case]]\nname = \"ideal\"\nservo = \"ideal\"\n",
      SERVOMILL_SOURCE_DIR "/scenarios/small.toml");
}

TEST(RowsOfTests, AreTheSameBeforeAndAfterARun) {
  const model::Scenario scenario = scenario_of_all();
  const std::vector<CaseOutput> outputs = {run_named_case(scenario, "ideal")};
  const auto before = rows_of_tests(scenario, {}), after = rows_of_tests(scenario, outputs);
  ASSERT_EQ(before.size(), after.size());
  std::size_t k = 0;
  for (const auto& one : outputs[0].tests) {
    for (const standards::ReportValue& value : one->report.values) {
      ASSERT_LT(k, after.size());
      EXPECT_EQ(after[k].quantity, value.symbol);
      EXPECT_EQ(after[k].sections, one->name);
      EXPECT_EQ(after[k].value, value.value / unit_of(value.dimension).factor) << value.symbol;
      EXPECT_EQ(before[k].quantity, value.symbol);
      EXPECT_EQ(before[k].sections, one->name);
      EXPECT_EQ(before[k].unit, after[k].unit);
      EXPECT_TRUE(std::isnan(before[k].value));
      ++k;
    }
  }
  EXPECT_EQ(k, after.size());
  EXPECT_EQ(after[0].case_name, "ideal");
}

TEST(RowsOfTests, HaveNoValuesOfACaseThatStopped) {
  const model::Scenario scenario = scenario_of_all();
  std::vector<CaseOutput> outputs(1);
  for (const auto& row : rows_of_tests(scenario, outputs)) EXPECT_TRUE(std::isnan(row.value));
}

}  // namespace
}  // namespace servomill::sim::run::test_comparison_test

// Comparisons of runs whose rows are thinned, against those of all rows.

#include <gtest/gtest.h>

#include <map>

#include "sim/evaluation/quantity.h"
#include "sim/model/scenario.h"
#include "sim/preparation/estimate.h"
#include "sim/records/row_thinning.h"
#include "sim/run/run_output.h"
#include "tests/sim/run/compared_cases.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::thinned_run_test {
namespace {

constexpr double kSingle = 1e-6;  // relative: means and rms are kept as float32
// um, of differences: the case that is compared with is linear from row to row, and the largest one
// may lie between rows, which depend on how well those before compress; 4 % of it
constexpr double kBetween = 0.8;

std::string program() {
  std::string text = "F1500\n";
  for (int pass = 0; pass < 8; ++pass) {
    text += "G1 X30 Y" + std::to_string(pass) + "\nX12 Z1\nG2 X0 Y" + std::to_string(pass + 1) +
            " Z0 R9\n";
  }
  return text + "M2\n";
}

std::string quantity(const std::string& name, const std::string& keys) {
  return "[[quantity]]\nname = \"" + name + "\"\n" + keys;
}

model::Scenario scenario(const std::string& record) {
  std::string quantities;
  for (const std::string statistic : {"max", "rms", "mean", "range"}) {
    const std::string keys = "statistic = \"" + statistic + "\"\n";
    quantities += quantity("following_error", "axis = \"X\"\n" + keys);
    quantities += quantity("tool_deviation", "axis = \"Y\"\n" + keys);
    for (const char* name : {"contour_error", "tcp_deviation", "tool_axis_deviation"}) {
      quantities += quantity(name, keys);
    }
  }
  const std::string baseline = "baseline = \"as_it_is\"\ncases = [\"feedback\"]\n";
  quantities += quantity("tool_difference", baseline);
  quantities += quantity("trajectory_difference", "axis = \"Y\"\n" + baseline);
  return small_scenario(program(), "machine_errors = \"measured\"\n[record]\n" + record +
                                       kComparedCases + quantities);
}

class ThinnedRun : public testing::Test {
 protected:
  const model::Scenario all = scenario("period_ms = 1.0\n");
  const model::Scenario thinned = scenario("max_size_GB = 0.001\n");
  const RunOutput of_all = run_scenario(all, {});
  const RunOutput of_thinned = run_scenario(thinned, {});
};

TEST_F(ThinnedRun, HasFewerRowsThatStandForAll) {
  for (std::size_t i = 0; i < of_all.cases.size(); ++i) {
    const records::Series& every = of_all.cases[i].result.servo;
    const records::Series& some = of_thinned.cases[i].result.servo;
    EXPECT_LT(some.rows(), every.rows() / 4);
    const std::size_t samples = some.column(records::kSamples).value();
    double sum = 0.0;
    for (std::size_t row = 0; row < some.rows(); ++row) sum += some.at(row, samples);
    EXPECT_EQ(sum, static_cast<double>(every.rows()));
  }
}

TEST_F(ThinnedRun, ComparesAsAllRowsDo) {
  ASSERT_EQ(of_all.comparison.size(), of_thinned.comparison.size());
  for (std::size_t i = 0; i < of_all.comparison.size(); ++i) {
    const evaluation::ComparisonRow &wanted = of_all.comparison[i],
                                    &found = of_thinned.comparison[i];
    SCOPED_TRACE(wanted.case_name + " " + wanted.quantity + " " + wanted.statistic);
    if (evaluation::quantity_entry(wanted.quantity).needs_baseline) {
      EXPECT_NEAR(found.value, wanted.value, kBetween);
      EXPECT_EQ(found.note, "at the recorded rows (record.period_ms)");
    } else if (wanted.statistic == "max" || wanted.statistic == "range") {
      EXPECT_EQ(found.value, wanted.value);
      EXPECT_EQ(found.note, "");
    } else {
      EXPECT_NEAR(found.value, wanted.value, kSingle * std::max(1.0, std::abs(wanted.value)));
    }
  }
}

TEST_F(ThinnedRun, IsEstimatedAndReported) {
  const preparation::RunEstimate takes = check_scenario(thinned);
  EXPECT_TRUE(takes.is_thinned);
  EXPECT_EQ(takes.file, 0.25e6);
  EXPECT_NE(
      preparation::thinning_message(takes).find("the file takes at most 0.00025 GB (a quarter of "
                                                "record.max_size_GB = 0.001)"),
      std::string::npos);
  EXPECT_FALSE(check_scenario(scenario("period_ms = 1.0\nmax_size_GB = 1\n")).is_thinned);
}

TEST_F(ThinnedRun, IsRefusedWhereThePeriodIsGiven) {
  EXPECT_THROW(check_scenario(scenario("period_ms = 1.0\nmax_size_GB = 0.001\n")), InputError);
}

}  // namespace
}  // namespace servomill::sim::run::thinned_run_test

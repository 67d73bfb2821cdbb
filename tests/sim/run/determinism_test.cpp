/// The same scenario gives the same bits; a machine that stops takes no other case with it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "sim/model/scenario.h"
#include "sim/run/run_output.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::run::determinism_test {
namespace {

const std::string kProgram =
    "G17 G64 P0.01\nG0 X-5 Y-5\nG1 X5 F2000\nG2 X5 Y5 I0 J5\nG1 X-5\nM30\n";

std::string strategy_case(const std::string& type, const std::string& more = "") {
  return fmt::format(
      "[[case]]\nname = \"{0}{1}\"\n[[case.strategy]]\ntype = \"{0}\"\nmodel = \"imposed\"\n"
      "action = \"impose\"\n{2}",
      type, more.empty() ? "" : "_more", more);
}

model::Scenario all_strategies() {
  return small_scenario(
      kProgram,
      "imposed = \"imposed\"\nmachine_errors = \"imposed\"\n[errors.imposed]\n"
      "EYX = { harmonic = { amplitude_um = 40.0, period_mm = 20.0 } }\n"
      "EXY = { polynomial_um = [1.0, 0.3] }\nEC0Y = \"50 urad\"\n"
      "[feedback_hardware]\nconnected = true\n"
      "[[case]]\nname = \"nominal\"\n" +
          strategy_case("table", "base_axis = \"X\"\nfrom_mm = -20.0\nto_mm = 20.0\n") +
          strategy_case("feedback") +
          strategy_case("feedback", "extrapolation_time_ms = \"auto\"\n") + strategy_case("gcode"));
}

bool same_bits(const std::vector<double>& one, const std::vector<double>& other) {
  if (one.size() != other.size()) return false;
  return one.empty() || std::memcmp(one.data(), other.data(), one.size() * sizeof(double)) == 0;
}

RunOutput run_with(const model::Scenario& scenario, unsigned threads) {
  RunControl control;
  control.threads = threads;
  return run_scenario(scenario, control);
}

TEST(RunScenario, GivesTheSameBitsForAnyNumberOfThreads) {
  const model::Scenario scenario = all_strategies();
  const RunOutput reference = run_with(scenario, 1);
  for (const unsigned threads : {1U, 2U, 5U}) {
    const RunOutput again = run_with(all_strategies(), threads);
    ASSERT_EQ(again.cases.size(), reference.cases.size());
    for (std::size_t i = 0; i < again.cases.size(); ++i) {
      const CaseOutput &a = reference.cases[i], &b = again.cases[i];
      EXPECT_EQ(a.name, b.name);
      ASSERT_EQ(a.program == nullptr, b.program == nullptr) << a.name;
      EXPECT_TRUE(a.program == nullptr || *a.program == *b.program) << a.name;
      EXPECT_TRUE(a.result.outcome.finished) << a.name << ": " << a.result.outcome.reason;
      EXPECT_GT(a.result.servo.rows(), 500U) << a.name;
      EXPECT_EQ(a.result.servo.by_rows(), b.result.servo.by_rows())
          << a.name << ", threads " << threads;
    }
  }
}

// Signals for a file are encoded while a case runs; those that quantities read stay beside.
void expect_same_if_stored(const model::Scenario& scenario) {
  const RunOutput plain = run_with(scenario, 2);
  RunControl control;
  control.stores_signals = true;
  const RunOutput stored = run_scenario(scenario, control);
  ASSERT_EQ(stored.cases.size(), plain.cases.size());
  for (std::size_t i = 0; i < plain.cases.size(); ++i) {
    const records::Series &one = plain.cases[i].result.servo, &other = stored.cases[i].result.servo;
    EXPECT_EQ(one.pages(), nullptr);
    EXPECT_NE(other.pages(), nullptr);
    EXPECT_TRUE(same_bits(other.by_rows(), one.by_rows())) << plain.cases[i].name;
    EXPECT_LE(other.pages()->page_rows(), std::max<std::size_t>(1, one.rows()));
  }
  ASSERT_EQ(stored.comparison.size(), plain.comparison.size());
  for (std::size_t i = 0; i < plain.comparison.size(); ++i) {
    EXPECT_TRUE(same_bits({stored.comparison[i].value}, {plain.comparison[i].value})) << i;
  }
}

// A small run, recorded so, with a case that stops early.
model::Scenario recorded(const std::string& record) {
  return small_scenario(
      "G1 X10 F2000\nG1 Y5\nM30\n",
      "[machine_override.nc]\ncheck_stability = false\nfollowing_error_limit_mm = 0.3\n"
      "[record]\n" +
          record +
          "[[case]]\nname = \"one\"\n[[case]]\nname = \"ideal\"\nservo = \"ideal\"\n"
          "[[quantity]]\nname = \"contour_error\"\n");
}

TEST(RunScenario, GivesTheSameBitsWhereSignalsAreStored) {
  expect_same_if_stored(all_strategies());
  for (const char* const record : {"", "compression = 0\n", "storage = \"float32\"\n",
                                   "extremes = true\n", "windows = { time_s = [[0.1, 0.2]] }\n"}) {
    SCOPED_TRACE(record);
    expect_same_if_stored(recorded(record));
  }
}

// Feedback of an error with slope 3 makes the loop unstable: y = x - 3 x. Only that case stops.
TEST(RunScenario, StopsTheCaseThatDivergesAndNoOther) {
  const model::Scenario scenario = small_scenario(
      "G1 X10 F2000\nM30\n",
      "[errors.mad]\nEXX = { polynomial_um = [0.0, 3000.0] }\n"
      "[machine_override.nc]\nfollowing_error_limit_mm = 2.0\n"
      "[[case]]\nname = \"before\"\n"
      "[[case]]\nname = \"mad\"\n[[case.strategy]]\ntype = \"feedback\"\nmodel = \"mad\"\n"
      "action = \"impose\"\nmax_um = 1e6\nmax_rate_mm_per_s = 1e6\n"
      "[[case]]\nname = \"after\"\n"
      "[[quantity]]\nname = \"following_error\"\naxis = \"X\"\n");
  const RunOutput out = run_with(scenario, 2);
  ASSERT_EQ(out.cases.size(), 3U);
  const engine::CaseResult& stopped = out.cases[1].result;
  EXPECT_FALSE(stopped.outcome.finished);
  EXPECT_EQ(stopped.outcome.axis, 'X');
  EXPECT_GT(stopped.outcome.time, 0.0);
  EXPECT_LT(stopped.outcome.time, out.cases[1].duration + 0.1);
  EXPECT_EQ(stopped.outcome.reason,
            fmt::format("axis X: following error beyond 2 mm at {:.4f} s", stopped.outcome.time));
  for (const std::size_t i : {0U, 2U}) {
    EXPECT_TRUE(out.cases[i].result.outcome.finished);
    EXPECT_EQ(out.cases[i].result.last_ticks.rows(), 0U);
    EXPECT_TRUE(std::isfinite(out.comparison[i].value));
  }
  EXPECT_TRUE(std::isnan(out.comparison[1].value));
  EXPECT_EQ(out.cases[0].result.servo.by_rows(), out.cases[2].result.servo.by_rows());
}

// Gains far beyond the limit, as an experiment: stops with axis and time, and what happened in the
// last position periods is kept, up to the one that went beyond the limit.
TEST(RunScenario, KeepsTheLastTicksOfALoopThatDiverges) {
  const model::Scenario scenario = small_scenario(
      "G1 X10 F2000\nM30\n",
      "[machine_override.nc]\ncheck_stability = false\nfollowing_error_limit_mm = 0.3\n"
      "[machine_override.axis.X]\nKv = \"2000 1/s\"\n"
      "[[case]]\nname = \"diverging\"\n[[case]]\nname = \"ideal\"\nservo = \"ideal\"\n");
  const RunOutput out = run_with(scenario, 2);
  const engine::CaseResult& stopped = out.cases[0].result;
  ASSERT_FALSE(stopped.outcome.finished);
  EXPECT_EQ(stopped.outcome.axis, 'X');
  const records::Series& last = stopped.last_ticks;
  ASSERT_GT(last.rows(), 10U);
  EXPECT_LE(last.rows(), 2000U);
  const auto error = [&](std::size_t row) {
    return std::abs(last.at(row, *last.column("cmd", 'X')) - last.at(row, *last.column("fb", 'X')));
  };
  for (std::size_t row = 0; row + 1 < last.rows(); ++row) EXPECT_LE(error(row), 0.3e-3);
  EXPECT_GT(error(last.rows() - 1), 0.3e-3);
  EXPECT_DOUBLE_EQ(last.at(last.rows() - 1, *last.column("time")), stopped.outcome.time);
  const std::size_t time = *stopped.servo.column("time");
  ASSERT_GT(stopped.servo.rows(), 0U);
  EXPECT_LE(stopped.servo.at(stopped.servo.rows() - 1, time), stopped.outcome.time);
  EXPECT_TRUE(out.cases[1].result.outcome.finished);
}

TEST(RunScenario, EndsEarlyWhenAskedTo) {
  const engine::StopFlag stop = true;
  RunControl control;
  control.stop = &stop;
  const RunOutput out = run_scenario(
      small_scenario("G1 X10 F2000\nM30\n",
                     "[[case]]\nname = \"one\"\n[[case]]\nname = \"ideal\"\nservo = \"ideal\"\n"),
      control);
  for (const CaseOutput& one : out.cases) {
    EXPECT_FALSE(one.result.outcome.finished) << one.name;
    EXPECT_EQ(one.result.outcome.reason, "interrupted at 0.0000 s") << one.name;
    EXPECT_EQ(one.result.outcome.axis, '-') << one.name;
  }
}

}  // namespace
}  // namespace servomill::sim::run::determinism_test

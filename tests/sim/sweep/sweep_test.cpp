#include "sim/sweep/sweep.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/progress.h"
#include "sim/model/scenario.h"
#include "sim/run/run.h"
#include "sim/run/run_case.h"
#include "sim/run/run_output.h"
#include "sim/sweep/run_sweep.h"

namespace servomill::sim::sweep::sweep_test {
namespace {

const std::string kScenario = SERVOMILL_SOURCE_DIR "/tests/cli/gallery/scenario.toml";

Sweep sweep_of(const std::string& table, std::vector<std::string> changes = {}) {
  changes.push_back("sweep={" + table + "}");
  return {kScenario, changes};
}

const std::string kSix =
    "program.feed_override=[1.0,2.0],"
    "case.table.strategy.time_constant_ms={linear=[0.0,20.0],count=3}";

// All points by number; runs them alone where no control says otherwise.
std::map<std::uint64_t, run::BatchResult> run_all(const Sweep& sweep, SweepControl control = {}) {
  std::map<std::uint64_t, run::BatchResult> results;
  control.batch_done = [&](std::vector<SweepPoint>&& points) {
    for (SweepPoint& one : points) {
      EXPECT_EQ(one.values, sweep.design().point(one.index));
      EXPECT_TRUE(results.emplace(one.index, std::move(one.result)).second) << one.index;
    }
  };
  run_sweep(sweep, {0, sweep.design().size()}, {}, control);
  return results;
}

// Bit for bit, NaN included.
void expect_same(const std::vector<evaluation::ComparisonRow>& a,
                 const std::vector<evaluation::ComparisonRow>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(std::memcmp(&a[i].value, &b[i].value, sizeof(double)), 0)
        << a[i].quantity << ": " << a[i].value << ' ' << b[i].value;
  }
}

void expect_same(const std::map<std::uint64_t, run::BatchResult>& a,
                 const std::map<std::uint64_t, run::BatchResult>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (const auto& [index, result] : a) {
    EXPECT_EQ(result.status, b.at(index).status);
    EXPECT_EQ(result.reason, b.at(index).reason);
    expect_same(result.rows, b.at(index).rows);
  }
}

TEST(Sweep, RunsEveryPointAsItWouldRunAlone) {
  const Sweep sweep = sweep_of(kSix);
  const auto results = run_all(sweep);
  ASSERT_EQ(results.size(), 6U);
  for (const auto& [index, result] : results) {
    EXPECT_EQ(result.status, run::PointStatus::done) << result.reason;
    expect_same(result.rows, run::run_scenario(sweep.at(index), {}).comparison);
  }
}

TEST(Sweep, DependsNeitherOnThreadsNorOnBatches) {
  const Sweep sweep = sweep_of(kSix);
  SweepControl one;
  one.threads = 1;
  one.batch = 1;
  const auto expected = run_all(sweep, one);
  for (const unsigned threads : {1U, 2U}) {
    for (const std::size_t batch : {std::size_t{2}, kBatchPoints}) {
      SweepControl control;
      control.threads = threads;
      control.batch = batch;
      expect_same(run_all(sweep, control), expected);
    }
  }
}

TEST(Sweep, LeavesOutWhatIsDone) {
  const Sweep sweep = sweep_of(kSix);
  std::vector<std::uint64_t> run;
  SweepControl control;
  control.threads = 1;
  control.batch_done = [&](std::vector<SweepPoint>&& points) {
    for (const SweepPoint& one : points) run.push_back(one.index);
  };
  run_sweep(sweep, {1, 6}, {true, false, true, true, false}, control);  // points 1 ... 5
  EXPECT_EQ(run, (std::vector<std::uint64_t>{2, 5}));
}

TEST(Sweep, KeepsSignalsOnRequest) {
  SweepControl control;
  control.keep = run::Keep::series;
  const auto results = run_all(sweep_of("program.feed_override=[1.0]"), control);
  ASSERT_EQ(results.at(0).cases->size(), 2U);
  EXPECT_EQ(results.at(0).cases->at(1).name, "table");
  EXPECT_GT(results.at(0).cases->at(1).result.servo.rows(), 100U);
}

TEST(Sweep, SaysWhyAPointIsRefusedAndGoesOn) {
  const auto results = run_all(sweep_of("program.feed_override=[1.0,-1.0,2.0]"));
  EXPECT_EQ(results.at(0).status, run::PointStatus::done);
  EXPECT_EQ(results.at(1).status, run::PointStatus::refused);
  EXPECT_EQ(results.at(1).reason,
            "sweep.\"program.feed_override\": program.feed_override = -1.0; must be > 0");
  EXPECT_TRUE(results.at(1).rows.empty());
  EXPECT_EQ(results.at(2).status, run::PointStatus::done);
}

TEST(Sweep, SaysWhereTheMachineStopped) {
  const auto results = run_all(sweep_of("machine.nc.following_error_limit_mm=[10.0,0.001]"));
  EXPECT_EQ(results.at(0).status, run::PointStatus::done);
  EXPECT_EQ(results.at(1).status, run::PointStatus::stopped);
  EXPECT_EQ(results.at(1).reason.substr(0, 43), "case nominal stopped: axis X: following err");
  EXPECT_TRUE(std::isnan(results.at(1).rows.at(0).value));
}

TEST(Sweep, RefusesPointsThatAskForSomethingElse) {
  const auto results =
      run_all(sweep_of("\"case[1].name\"=[\"table\",\"tabel\"]",
                       {"quantity[0].cases=[\"nominal\"]", "quantity[0].baseline=nominal"}));
  EXPECT_EQ(results.at(0).status, run::PointStatus::done);
  EXPECT_EQ(results.at(1).status, run::PointStatus::done);
  const auto others = run_all(
      sweep_of("\"case[0].name\"=[\"nominal\",\"ideal\"]", {"quantity=[{name=\"cycle_time\"}]"}));
  EXPECT_EQ(others.at(1).status, run::PointStatus::refused);
  EXPECT_EQ(others.at(1).reason,
            "has other quantities or cases than the scenario without its sweep");
}

TEST(Sweep, GivesUpWhenItsResultsCannotBeWritten) {
  SweepControl control;
  control.batch = 1;
  control.threads = 2;
  control.batch_done = [](std::vector<SweepPoint>&&) { throw std::runtime_error("disk full"); };
  const Sweep sweep = sweep_of(kSix);
  EXPECT_THROW(run_sweep(sweep, {0, 6}, {}, control), std::runtime_error);
}

TEST(Sweep, EndsWhenItIsStopped) {
  const engine::StopFlag stop = true;
  SweepControl control;
  control.stop = &stop;
  EXPECT_TRUE(run_all(sweep_of(kSix), control).empty());
}

TEST(Sweep, TellsItsProgress) {
  const ProgressWatch watch;
  SweepControl control;
  std::size_t ended = 0;
  control.batch_done = [&](std::vector<SweepPoint>&& points) {
    ended += points.size();
    const std::vector<StageState> stages = watch.stages();
    ASSERT_EQ(stages.size(), 1U);
    EXPECT_EQ(stages.front().counted, "points");
    EXPECT_EQ(stages.front().total, 6.0);
  };
  run_sweep(sweep_of(kSix), {0, 6}, {}, control);
  EXPECT_EQ(ended, 6U);
  EXPECT_TRUE(watch.stages().empty());
}

std::string refusal(const std::string& table) {
  try {
    sweep_of(table).refuse_hopeless();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(ValueOfASweptKey, IsRefused) {
  const auto refused = [](const std::string& table, const std::string& change) -> std::string {
    try {
      sweep_of(table, {change});
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  const std::string feed = "program.feed_override=[1.0,2.0]";
  EXPECT_EQ(refused(feed, "program.feed_override=0.3"),
            "--set program.feed_override=0.3: error: the sweep varies program.feed_override "
            "(--set sweep={program.feed_override=[1.0,2.0]}); this value would never be used");
  const std::string time = "case.table.strategy.time_constant_ms=[1,2]";
  EXPECT_EQ(refused(time, "case[1].strategy[0].time_constant_ms=3"),
            "--set case[1].strategy[0].time_constant_ms=3: error: the sweep varies "
            "case.table.strategy.time_constant_ms (--set sweep={" +
                time + "}); this value would never be used")
      << "another spelling of the same key";
  EXPECT_EQ(refused(feed, "record.period_ms=1.0"), "accepted");
  EXPECT_EQ(refused("machine.nc.Kv=[50,60]", "machine.solver_tolerance_nm=1"), "accepted");
}

TEST(RefuseHopeless, AcceptsWhatIsWrongAtSomePoints) {
  EXPECT_EQ(refusal("program.feed_override=[-1.0,1.0]"), "accepted");
  EXPECT_EQ(refusal("machine.nc.Kv=[5000,60]"), "accepted");
}

TEST(RefuseHopeless, NamesAKeyThatThereIsNot) {
  const std::string begin = "--set sweep={program.feed_overide=[0.5,1.0]}: error: ";
  EXPECT_EQ(refusal("program.feed_overide=[0.5,1.0]"),
            begin +
                "sweep.\"program.feed_overide\": program.feed_overide is not known; did you mean "
                "'feed_override', which is also given?");
  EXPECT_EQ(refusal("case.tabel.strategy.time_constant_ms=[1,2]"),
            "--set sweep={case.tabel.strategy.time_constant_ms=[1,2]}: error: "
            "sweep.\"case.tabel.strategy.time_constant_ms\": case is a list without an item "
            "'tabel'; did you mean 'table'?");
  EXPECT_EQ(
      refusal("case.table.strategy.time_constan_ms=[1,2]"),
      "--set sweep={case.table.strategy.time_constan_ms=[1,2]}: error: "
      "sweep.\"case.table.strategy.time_constan_ms\": case[1].strategy[0].time_constan_ms is not "
      "known; did you mean 'time_constant_ms'?");
}

TEST(RefuseHopeless, TellsAFaultOfAllOfManyPoints) {
  EXPECT_EQ(refusal("program.feed_overide={linear=[0.5,1.0],count=1000}"),
            "--set sweep={program.feed_overide={linear=[0.5,1.0],count=1000}}: error: "
            "sweep.\"program.feed_overide\": program.feed_overide is not known; did you mean "
            "'feed_override', which is also given?");
}

}  // namespace
}  // namespace servomill::sim::sweep::sweep_test

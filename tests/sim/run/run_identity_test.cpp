#include "sim/run/run_identity.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>

#include "sim/engine/simulate.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/prepare_cases.h"
#include "sim/run/point_batch.h"

namespace servomill::sim::run {
namespace {

// Three cases on a machine with errors: none, and strategies that know two models.
model::Scenario scenario_with(std::vector<std::string> more) {
  std::vector<std::string> changes = {
      "errors.good.EXX.harmonic={amplitude_um=20.0,period_mm=30.0}",
      "errors.bad.EXX.harmonic={amplitude_um=10.0,period_mm=30.0}",
      "machine_errors=\"good\"",
      "case=[{name=\"none\"},{name=\"one\",strategy=[{type=\"gcode\",model=\"good\"}]},"
      "{name=\"other\",strategy=[{type=\"feedback\",model=\"bad\"}]}]",
      "quantity=[{name=\"contour_error\",statistic=\"max\"}]",
      "program.feed_override=3.0"};
  std::move(more.begin(), more.end(), std::back_inserter(changes));
  return input::read_scenario(SERVOMILL_SOURCE_DIR "/tests/cli/gallery/scenario.toml", changes);
}

// Names of the cases whose runs are the same in both scenarios.
std::string same_runs(const std::vector<std::string>& changes_of_one,
                      const std::vector<std::string>& changes_of_other) {
  preparation::PreparationCache cache;
  const model::Scenario one = scenario_with(changes_of_one),
                        other = scenario_with(changes_of_other);
  const auto a = preparation::prepare_cases(one, &cache);
  const auto b = preparation::prepare_cases(other, &cache);
  std::string same;
  for (std::size_t k = 0; k < a.size(); ++k) {
    for (std::size_t l = 0; l < b.size(); ++l) {
      if (!RunIdentity(a[k], a[k].inputs(), k).is_same_as({b[l], b[l].inputs(), l})) continue;
      EXPECT_EQ(k, l) << "cases of different names";
      same += a[k].spec().name + " ";
    }
  }
  return same;
}

TEST(RunIdentity, IsThatOfCasesWhichAChangeDoesNotReach) {
  EXPECT_EQ(same_runs({}, {}), "none one other ");
  EXPECT_EQ(same_runs({}, {"errors.bad.EXX.harmonic.amplitude_um=9.0"}), "none one ");
  EXPECT_EQ(same_runs({}, {"errors.good.EXX.harmonic.amplitude_um=9.0"}), "");  // of the machine
  EXPECT_EQ(same_runs({}, {"case.one.strategy.tolerance_um=0.5"}), "none other ");
  EXPECT_EQ(same_runs({}, {"case.none.machine_errors=\"bad\""}), "one other ");
  EXPECT_EQ(same_runs({}, {"case.other.machine_override.nc.Kv=\"50 1/s\""}), "none one ");
  EXPECT_EQ(same_runs({}, {"quantity=[{name=\"cycle_time\"}]"}), "none one other ");
}

TEST(RunIdentity, IsAnotherWithWhatAllCasesShare) {
  for (const char* change :
       {"machine.nc.Kv=\"50 1/s\"", "machine.axis.X.Kt=1.5", "program.feed_override=2.0",
        "record.period_ms=2.0", "record.resolution_nm=10.0", "record.settle_ms=7.0",
        "machine.axis.Y.i_max_A=100", "program.start.X_mm=1.0",
        "feedback_hardware.signal_delay_us=50.0"}) {
    EXPECT_EQ(same_runs({}, {change}), "") << change;
  }
}

TEST(DocumentOfRun, HasOneCaseAndNoErrors) {
  const std::string toml =
      "a = 1\nt = \"\"\"\n[errors]\n[[case]]\n\"\"\"\n[program]\nb = 2\n[errors.x]\nc = "
      "3\n[errors.x.EXX]\n"
      "c = 4\n[[case]]\nname = \"p\"\n[[case.strategy]]\nd = 5\n[[case]]\nname = \"q\"\n"
      "[[quantity]]\ne = 6\n[sweep]\nf = 7\n[record]\ng = 8\n";
  EXPECT_EQ(config::inline_toml(document_of_run(toml, 0)),
            "{ a = 1, t = \"\"\"\n[errors]\n[[case]]\n\"\"\", program = { b = 2 }, case = [{ name "
            "= \"p\", "
            "strategy = [{ d = 5 }] }], record = { g = 8 } }");
  EXPECT_EQ(config::inline_toml(document_of_run(toml, 1)),
            "{ a = 1, t = \"\"\"\n[errors]\n[[case]]\n\"\"\", program = { b = 2 }, case = [{ name "
            "= \"q\" }], "
            "record = { g = 8 } }");
}

// A header in a text of several lines, which a comparison of lines took for one, hides nothing.
TEST(RunIdentity, OfAScenarioWithATextOfSeveralLines) {
  const std::string remark = "source=\"\"\"\n[errors]\nwhat follows is read\n\"\"\"";
  EXPECT_EQ(same_runs({remark}, {remark}), "none one other ");
  EXPECT_EQ(same_runs({remark}, {remark, "record.period_ms=2.0"}), "");
}

// Each point of a batch has the rows that it has alone, where others have the same runs.
TEST(RunBatch, SharesTheSameRuns) {
  std::vector<model::Scenario> points;
  for (int k = 0; k < 5; ++k) {
    points.push_back(scenario_with(
        {fmt::format("errors.bad.EXX.harmonic.amplitude_um={}", 8.0 + 2.0 * (k % 3)),
         fmt::format("machine.nc.following_error_limit_mm={}", k == 4 ? 1e-3 : 9.0)}));
  }
  const engine::StopFlag never = false;
  std::atomic<float> progress = 0.0F;
  const auto results_of = [&](std::span<const model::Scenario> some) {
    preparation::PreparationCache cache;
    std::map<std::size_t, BatchResult> results;
    run_batch(some, never, progress,
              [&](std::vector<EndedPoint>&& ended) {
                for (EndedPoint& one : ended) results[one.place] = std::move(one.result);
              },
              {.cache = &cache});
    return results;
  };
  auto together = results_of(points);
  ASSERT_EQ(together.size(), points.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    auto alone = results_of({&points[k], 1});
    EXPECT_EQ(together[k].status, k == 4 ? PointStatus::stopped : PointStatus::done);
    EXPECT_EQ(together[k].reason, alone[0].reason);
    ASSERT_EQ(together[k].rows.size(), 3U);
    for (std::size_t n = 0; n < 3 && k != 4; ++n) {
      EXPECT_EQ(together[k].rows[n].value, alone[0].rows[n].value) << k << " " << n;
    }
  }
}

}  // namespace
}  // namespace servomill::sim::run

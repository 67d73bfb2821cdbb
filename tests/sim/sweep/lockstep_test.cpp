/// Points that run in lockstep: what happens to one of them is nothing to the others.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "sim/engine/case_result.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/run/point_batch.h"
#include "sim/run/run_case.h"

namespace servomill::sim::sweep::lockstep_test {
namespace {

const std::string kScenario = SERVOMILL_SOURCE_DIR "/tests/cli/gallery/scenario.toml";

model::Scenario scenario_with(const std::vector<std::string>& more) {
  std::vector<std::string> changes = {
      "case=[{name=\"only\"}]",
      "quantity=[{name=\"following_error\",axis=\"X\",statistic=\"max\"}]",
      "record.resolution_nm=0.0",  // every bit
      "program.feed_override=3.0",
  };
  changes.insert(changes.end(), more.begin(), more.end());
  return input::read_scenario(kScenario, changes);
}

// Settings in which one of eight may differ from the others.
const std::map<std::string, std::vector<std::string>> kOdd = {
    {"overflows",
     {"machine.axis.X.velocity_bandwidth=1e100", "machine.axis.X.i_max_A=1.7e308",
      "machine.axis.X.Kt=100", "machine.nc.check_stability=false",
      "machine.nc.following_error_limit_mm=1.7e308"}},
    {"faults", {"machine.nc.following_error_limit_mm=0.001"}},
    {"ends early", {"program.feed_override=9.0"}},
    {"uses cvode", {"machine.integrator=\"cvode\""}},
    {"has a winding",
     {"machine.axis.X.current_loop=\"pi\"",
      "machine.axis.X.winding={inductance=\"4 mH\",resistance=\"0.6 ohm\",bandwidth=\"3000 "
      "rad/s\"}"}},
    {"has friction",
     {"machine.axis.X.friction={model=\"set_valued\",coulomb=\"450 N\",breakaway=\"560 N\","
      "stribeck_velocity=\"2 mm/s\"}"}},
    {"has regularised friction",
     {"machine.axis.X.friction={model=\"regularised\",coulomb=\"450 N\",breakaway=\"560 N\","
      "stribeck_velocity=\"2 mm/s\",regularisation_velocity=\"0.1 mm/s\"}"}},
    {"has bristles",
     {"machine.axis.X.friction={model=\"lugre\",coulomb=\"450 N\",breakaway=\"560 N\","
      "stribeck_velocity=\"2 mm/s\",bristle_stiffness=\"45 N/um\",bristle_damping=\"30 kN "
      "s/m\"}"}},
    {"is ideal", {"case[0].servo=\"ideal\""}},
};

// The k-th of eight runs that differ a little.
model::Scenario usual(std::size_t k) {
  return scenario_with({fmt::format("machine.nc.Kv={}", 50 + k)});
}

std::map<std::size_t, run::BatchResult> run(const std::vector<model::Scenario>& points,
                                            const engine::StopFlag& stop = false) {
  std::atomic<float> progress = 0.0F;
  preparation::PreparationCache cache;  // else each has a strategy of its own
  std::map<std::size_t, run::BatchResult> results;
  const auto keep = [&](std::vector<run::EndedPoint>&& ended) {
    for (run::EndedPoint& one : ended) {
      EXPECT_TRUE(results.emplace(one.place, std::move(one.result)).second) << one.place;
    }
  };
  run::run_batch(points, stop, progress, keep, {.keep = run::Keep::series, .cache = &cache});
  return results;
}

// Bit for bit, NaN included.
bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  if (a.size() != b.size()) return false;
  return a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

void expect_same(const run::BatchResult& one, const run::BatchResult& other, std::size_t place) {
  EXPECT_EQ(other.status, one.status) << other.reason;
  EXPECT_EQ(other.reason, one.reason);
  ASSERT_EQ(other.cases->size(), 1U);
  const engine::CaseResult &a = one.cases->at(0).result, &b = other.cases->at(0).result;
  EXPECT_TRUE(same_bits(a.servo.by_rows(), b.servo.by_rows())) << "run " << place;
  EXPECT_TRUE(same_bits(a.last_ticks.by_rows(), b.last_ticks.by_rows())) << "run " << place;
}

class Lockstep : public testing::TestWithParam<std::string> {};

TEST_P(Lockstep, GivesEachTheBitsThatItHasAlone) {
  static const std::vector<run::BatchResult> kAlone = [] {
    std::vector<run::BatchResult> alone;
    for (std::size_t k = 0; k < 8; ++k) alone.push_back(std::move(run({usual(k)}).at(0)));
    return alone;
  }();
  const model::Scenario odd = scenario_with(kOdd.at(GetParam()));
  const auto odd_alone = run({odd});
  for (const std::size_t place : {std::size_t{0}, std::size_t{4}}) {
    std::vector<model::Scenario> points;
    for (std::size_t k = 0; k < 8; ++k) points.push_back(k == place ? odd : usual(k));
    const auto together = run(points);
    ASSERT_EQ(together.size(), 8U);
    for (std::size_t k = 0; k < 8; ++k) {
      expect_same(k == place ? odd_alone.at(0) : kAlone[k], together.at(k), k);
      if (k != place) {
        EXPECT_EQ(together.at(k).status, run::PointStatus::done) << together.at(k).reason;
      }
    }
  }
}

std::vector<std::string> names_of_odd() {
  std::vector<std::string> names;
  for (const auto& [name, changes] : kOdd) names.push_back(name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(OneOfEight, Lockstep, testing::ValuesIn(names_of_odd()),
                         [](const auto& one) {
                           std::string name = one.param;
                           std::replace(name.begin(), name.end(), ' ', '_');
                           return name;
                         });

// The runs differ as the table above says.
TEST(Lockstep, HasOddRunsThatAreOdd) {
  std::map<std::string, run::BatchResult> odd;
  for (const auto& [name, changes] : kOdd) odd[name] = std::move(run({scenario_with(changes)})[0]);
  const auto series = [&](const std::string& name) -> const records::Series& {
    return odd.at(name).cases->at(0).result.servo;
  };
  const std::vector<double> last = odd.at("overflows").cases->at(0).result.last_ticks.by_rows();
  EXPECT_TRUE(std::any_of(last.begin(), last.end(), [](double x) { return !std::isfinite(x); }));
  EXPECT_EQ(odd.at("faults").status, run::PointStatus::stopped);
  EXPECT_NE(odd.at("faults").reason.find("following error beyond 0.001 mm"), std::string::npos);
  for (const char* name : {"ends early", "uses cvode", "has a winding", "has friction",
                           "has regularised friction", "has bristles", "is ideal"}) {
    EXPECT_EQ(odd.at(name).status, run::PointStatus::done) << name << ": " << odd.at(name).reason;
  }
  EXPECT_LT(series("ends early").rows(), series("has a winding").rows());
}

// Virtual encoders of two strategies in turn, at feeds of their own, one with a machine that stops:
// they end one by one, until one of each strategy is left, and then one of all.
TEST(Lockstep, OfVirtualEncodersGivesEachTheBitsThatItHasAlone) {
  std::vector<model::Scenario> points;
  for (std::size_t k = 0; k < 8; ++k) {
    const bool leads = k % 2 == 1;
    std::vector<std::string> changes = {
        fmt::format("case=[{{name=\"only\",strategy=[{{type=\"feedback\",model=\"imposed\","
                    "action=\"impose\",iterations=\"converged\",extrapolation_time_ms={}}}]}}]",
                    leads ? "\"auto\"" : "0"),
        fmt::format("program.feed_override={}", 3.0 + 0.5 * static_cast<double>(k))};
    if (k == 5) changes.push_back("machine.nc.following_error_limit_mm=0.001");
    points.push_back(scenario_with(changes));
  }
  const auto together = run(points);
  ASSERT_EQ(together.size(), 8U);
  for (std::size_t k = 0; k < 8; ++k) {
    EXPECT_EQ(together.at(k).status, k == 5 ? run::PointStatus::stopped : run::PointStatus::done);
    expect_same(run({points[k]}).at(0), together.at(k), k);
  }
}

TEST(RunBatch, TellsOfPointsAsSoonAsTheyHaveEnded) {
  std::vector<model::Scenario> points;
  for (int k = 0; k < 12; ++k) points.push_back(scenario_with({}));
  points[5] = scenario_with({"machine.nc.Kv=5000"});  // refused before anything runs
  engine::StopFlag stop = false;
  std::atomic<float> progress = 0.0F;
  std::vector<std::vector<std::size_t>> reported;
  run::run_batch(points, stop, progress, [&](std::vector<run::EndedPoint>&& ended) {
    reported.emplace_back();
    for (const run::EndedPoint& one : ended) reported.back().push_back(one.place);
    stop = reported.size() == 2;  // what has ended by then is kept, the others are never reported
  });
  EXPECT_EQ(reported, (std::vector<std::vector<std::size_t>>{{5}, {0, 1, 2, 3, 4, 6, 7, 8}}));
}

TEST(RunBatch, HoldsNoMoreRowsAtOnceThanItMay) {
  const std::vector<model::Scenario> points(3, scenario_with({}));
  const engine::StopFlag never = false;
  std::atomic<float> progress = 0.0F;
  std::vector<std::size_t> reported;
  const auto tell = [&](std::vector<run::EndedPoint>&& ended) {
    ASSERT_EQ(ended.size(), 1U);
    reported.push_back(ended.front().place);
  };
  run::run_batch(points, never, progress, tell, {.rows = 1.0});
  EXPECT_EQ(reported, (std::vector<std::size_t>{0, 1, 2}));
  EXPECT_EQ(progress, 1.0F);
}

TEST(RowsAtOnce, ShareTheMemoryAmongTheThreads) {
  EXPECT_LE(run::rows_at_once(1), run::kMaxRows);
  EXPECT_GT(run::rows_at_once(1000), 0.0);
  EXPECT_DOUBLE_EQ(run::rows_at_once(100000), run::rows_at_once(200000) * 2.0);
}

}  // namespace
}  // namespace servomill::sim::sweep::lockstep_test

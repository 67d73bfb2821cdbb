/// Sweeps share what their points have in common, and no result shows it.
#include "sim/preparation/preparation_cache.h"
#include "sim/config/document.h"
#include "sim/input/read_scenario.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <boost/random/mersenne_twister.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <boost/random/uniform_real_distribution.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

#include "sim/engine/simulate.h"
#include "sim/input/scenario_source.h"
#include "sim/model/scenario.h"
#include "sim/preparation/prepare_cases.h"
#include "sim/run/run.h"
#include "sim/run/run_case.h"
#include "sim/run/run_output.h"

namespace servomill::sim::preparation::preparation_cache_test {
namespace {

namespace fs = std::filesystem;

// Every strategy, a case with a machine of its own, a circle to be evaluated; short.
const std::string kScenario = fmt::format(R"(
machine = "{}/scenarios/machines/hsm600u.toml"
imposed = "imposed"
machine_errors = "other"
[program]
file = "small.ngc"
text = '''
T1 M6
G17 G64 P0.05
G43 H1
G0 X3 Y3 Z0
F4000
(MSG, ccw)
G3 X3 Y3 I-3 J-3
(MSG, line)
G1 X#101
M30
'''
parameters = {{ "#101" = 5.0 }}
work_offset = {{ X_mm = 1.0 }}
start = {{ Z_mm = 200.0 }}
[[program.tool]]
number = 1
length_mm = 110.0
[errors.imposed]
EYX = {{ harmonic = {{ amplitude_um = 40.0, period_mm = 20.0, phase_deg = 10.0 }} }}
EXY = {{ polynomial_um = [1.0, 0.3] }}
EC0Y = "50 urad"
[errors.other]
EZX = {{ table = {{ at_mm = [0.0, 50.0], value_um = [0.0, 3.0] }} }}
[feedback_hardware]
connected = true
[record]
settle_ms = 10.0
[[case]]
name = "nominal"
[[case]]
name = "stiff"
[case.machine_override.nc]
Kv = "80 1/s"
[[case]]
name = "table"
work_offset = {{ C_deg = 90.0 }}
[[case.strategy]]
type = "table"
model = "imposed"
action = "impose"
base_axis = "X"
from_mm = -20.0
to_mm = 20.0
spacing_mm = 1.6384
[[case]]
name = "feedback"
[[case.strategy]]
type = "feedback"
model = "imposed"
extrapolation_time_ms = "auto"
[[case]]
name = "gcode"
[[case.strategy]]
type = "gcode"
model = "imposed"
max_block_mm = 2.0
[[quantity]]
name = "circular_error"
sections = ["ccw"]
[[quantity]]
name = "imposed_error_residual"
axis = "Y"
baseline = "nominal"
[[quantity]]
name = "contour_error"
statistic = "rms"
)",
                                          SERVOMILL_SOURCE_DIR);

class Sharing : public testing::Test {
 protected:
  Sharing() : path_(testing::TempDir() + "servomill_sharing.toml") {
    std::ofstream(path_) << kScenario;
  }
  ~Sharing() override { fs::remove(path_); }
  const std::string path_;
};

// All that a run would be given, byte for byte, or why there is none.
std::string prepared(const model::Scenario& scenario, PreparationCache* cache) {
  system::MemoKey all;
  try {
    for (const PreparedCase& one : prepare_cases(scenario, cache)) {
      engine::CaseInputs in = one.inputs();
      controllers::Trajectory::Cursor cursor{};
      constexpr double kModelPeriod = 60e-6;  // s
      const auto feedback = in.feedback ? in.feedback->feedback(kModelPeriod) : nullptr;
      all.add(in.reference.duration());
      for (int k = 0; k <= 20; ++k) {
        const auto at = in.reference.at(in.reference.duration() * k / 20.0, cursor);
        all.add(at.Q_ref);
        all.add(at.s);
        all.add(in.machine_errors.error(at.Q_ref, in.tips.begin()->second).dp_W);
        all.add(in.imposed->joint_offset(at.Q_ref, in.tips.rbegin()->second));
        for (const auto& part : in.setpoints) all.add(part->offset(at.Q_ref));
        if (!feedback) continue;
        if (k == 0) feedback->settle(at.Q_ref);
        all.add(feedback->advance(at.Q_ref));
      }
      all.add(in.path.length());
      all.add(in.path.piece(0).end);
      const run::CaseOutput out = run::output_of(one, {});
      all.add(out.program != nullptr ? out.program->all() : std::string());
      all.add(out.blocks);
    }
  } catch (const InputError& error) {
    return error.what();
  }
  return all.bytes();
}

// Dotted paths of all numbers of a document, as --set takes them, with other values.
void collect_changes(const config::Value& value, const std::string& path,
                     std::vector<std::string>& out) {
  if (value.type == config::Value::Type::integer)
    out.push_back(fmt::format("{}={}", path, value.integer + 1));
  if (value.type == config::Value::Type::real) {
    out.push_back(fmt::format("{}={}", path, value.real == 0.0 ? 1e-3 : 1.03125 * value.real));
  }
  if (value.type == config::Value::Type::text) {
    char* end = nullptr;
    const double number = std::strtod(value.text.c_str(), &end);
    if (end != value.text.c_str()) {
      out.push_back(fmt::format("{}=\"{}{}\"", path, 1.03125 * number, end));
    }
  }
  std::size_t item = 0;
  for (const config::Value& child : value.children) {
    const bool is_list = value.type == config::Value::Type::list;
    collect_changes(
        child, is_list ? fmt::format("{}[{}]", path, item++) : config::joined_key(path, child.key),
        out);
  }
}

std::vector<std::string> changes_of_every_number(const model::Scenario& scenario) {
  std::vector<std::string> out;
  collect_changes(config::Document::from_text(scenario.resolved, "resolved").root(), "", out);
  return out;
}

TEST_F(Sharing, ShowsInNoResultWhateverNumberChanges) {
  const input::ScenarioSource source(path_);
  PreparationCache cache;
  const std::string unchanged = prepared(source.at(), &cache);
  std::size_t different = 0, refused = 0;
  const auto changes = changes_of_every_number(source.at());
  for (const std::string& change : changes) {
    try {
      const model::Scenario scenario = source.at({change});
      const std::string alone = prepared(scenario, nullptr);
      EXPECT_TRUE(prepared(scenario, &cache) == alone) << change;
      different += alone != unchanged ? 1 : 0;
    } catch (const InputError&) {
      ++refused;
    }
  }
  EXPECT_GT(changes.size(), 150U);
  EXPECT_GT(different, 20U);  // program, limits, errors, strategies; a run asks for the rest itself
  EXPECT_LT(refused, changes.size() / 5);
  EXPECT_TRUE(prepared(source.at(), &cache) == unchanged);
}

TEST_F(Sharing, ReadsAScenarioWithChangesAsIfItWereReadAnew) {
  const std::vector<std::string> base = {"machine.nc.Kv=70", "program.feed_override=0.5"};
  const input::ScenarioSource source(path_, base);
  std::vector<std::string> changes = changes_of_every_number(source.at());
  for (const char* more :
       {"machine_override.nc.Kv=50", "machine=nowhere.toml", "machine=3", "case[9].name=x",
        "case[0].name.x=1", "nonsense=1", "program.start[0]=1", "machine.axis.X.lead_mm=-1"}) {
    changes.emplace_back(more);
  }
  const auto text_of = [](const auto& read) -> std::string {
    try {
      const model::Scenario scenario = read();
      return scenario.resolved + scenario.machine_text + scenario.text + scenario.name;
    } catch (const InputError& error) {
      return error.what();
    }
  };
  for (std::size_t i = 0; i < changes.size(); i += 3) {
    std::vector<std::string> all = base;
    all.push_back(changes[i]);
    EXPECT_EQ(text_of([&] { return source.at({changes[i]}); }),
              text_of([&] { return input::read_scenario(path_, all); }))
        << changes[i];
  }
}

TEST_F(Sharing, GivesTheSameComparisonBitForBit) {
  const input::ScenarioSource source(path_);
  PreparationCache cache;
  boost::random::mt19937 random(4);
  const boost::random::uniform_real_distribution<double> factor(0.8, 1.25);
  const boost::random::uniform_int_distribution<int> which(0, 3);
  for (int point = 0; point < 6; ++point) {
    std::vector<std::string> changes = {fmt::format("machine.nc.Kv={}", 60.0 * factor(random))};
    const double x = factor(random);
    changes.push_back(std::array{fmt::format("program.feed_override={}", x),
                                 fmt::format("machine.axis.Y.j_max={}", 100.0 * x),
                                 fmt::format("errors.imposed.EC0Y=\"{} urad\"", 50.0 * x),
                                 fmt::format("program.parameters.\"#101\"={}",
                                             5.0 * x)}[static_cast<std::size_t>(which(random))]);
    const model::Scenario scenario = source.at(changes);
    run::RunControl shared;
    shared.cache = &cache;
    const auto with = run::run_scenario(scenario, shared).comparison;
    const auto without = run::run_scenario(scenario, {}).comparison;
    ASSERT_EQ(with.size(), without.size());
    for (std::size_t i = 0; i < with.size(); ++i) {
      EXPECT_EQ(with[i].value, without[i].value) << with[i].quantity << ", " << with[i].case_name;
      EXPECT_FALSE(std::isnan(with[i].value)) << with[i].quantity << ", " << with[i].case_name;
    }
  }
}

TEST_F(Sharing, LeavesOnlyTheLoopsToBeCheckedWhereAGainChanges) {
  const input::ScenarioSource source(path_);
  PreparationCache cache;
  const auto prepare_at = [&](const std::string& change) {
    const model::Scenario scenario = source.at({change});
    prepare_cases(scenario, &cache);
  };
  prepare_at("program.feed_override=1.0");
  const std::size_t programs = cache.programs.made(), motions = cache.motions.made();
  EXPECT_EQ(programs, 2U);  // with and without the work offset of a case
  EXPECT_EQ(motions, 3U);   // and of the rewritten program
  EXPECT_EQ(cache.rewritten.made(), 1U);
  EXPECT_EQ(cache.circles.made(), 1U);
  const std::size_t radii = cache.spectral_radii.made(), models = cache.models.made();
  EXPECT_EQ(radii, 10U);  // five axes of two machines
  prepare_at("machine.nc.Kv=61");
  EXPECT_EQ(cache.programs.made(), programs);
  EXPECT_EQ(cache.motions.made(), motions);
  EXPECT_EQ(cache.rewritten.made(), 1U);
  EXPECT_EQ(cache.circles.made(), 1U);
  EXPECT_EQ(cache.models.made(), models);
  EXPECT_EQ(cache.spectral_radii.made(), radii + 5);      // the other machine overrides Kv
  prepare_at("machine.axis.X.friction.model=\"lugre\"");  // no part of the linear loop
  EXPECT_EQ(cache.spectral_radii.made(), radii + 5);
  prepare_at("program.feed_override=0.5");
  EXPECT_EQ(cache.programs.made(), programs);
  EXPECT_EQ(cache.rewritten.made(), 1U);
  EXPECT_EQ(cache.motions.made(), 2 * motions);
  prepare_at("machine.axis.X.moving_mass= \"700 kg\"");
  EXPECT_EQ(cache.motions.made(), 2 * motions);
}

TEST_F(Sharing, RefusesUnstableGainsTheSecondTimeToo) {
  const input::ScenarioSource source(path_);
  PreparationCache cache;
  const auto complaint = [&](const std::string& Kv) {
    return prepared(source.at({"machine.axis.Y.Kv=" + Kv}), &cache);
  };
  const std::string first = complaint("5000");
  EXPECT_NE(first.find("axis Y: the servo loop is unstable with Kv = 5000 1/s"), std::string::npos)
      << first;
  EXPECT_NE(first.find("--set machine.axis.Y.Kv=5000:"), std::string::npos) << first;
  EXPECT_EQ(complaint("5000"), first);
  // the same loops, written elsewhere: the complaint stands there
  const std::string other = complaint("\"5000 1/s\"");
  EXPECT_NE(other.find("--set machine.axis.Y.Kv=\"5000 1/s\":"), std::string::npos) << other;
}

TEST_F(Sharing, ServesManyThreads) {
  const input::ScenarioSource source(path_);
  constexpr int kPoints = 12;
  const auto change = [](int i) {
    return std::vector<std::string>{fmt::format("program.feed_override={}", 0.5 + 0.25 * (i % 3)),
                                    fmt::format("machine.nc.Kv={}", 50 + i % 4)};
  };
  std::vector<std::string> alone(kPoints), shared(kPoints);
  for (int i = 0; i < kPoints; ++i) {
    alone[static_cast<std::size_t>(i)] = prepared(source.at(change(i)), nullptr);
  }
  PreparationCache cache;
  std::atomic<int> next = 0;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&] {
        for (int i = next++; i < kPoints; i = next++) {
          shared[static_cast<std::size_t>(i)] = prepared(source.at(change(i)), &cache);
        }
      });
    }
  }
  EXPECT_TRUE(shared == alone);
  EXPECT_EQ(cache.motions.made(), 9U);  // three of each of the three feeds
}

}  // namespace
}  // namespace servomill::sim::preparation::preparation_cache_test

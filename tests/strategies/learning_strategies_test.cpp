// The strategies that learn as they are declared: which runs they ask for, and how they act before
// and after.
#include <gtest/gtest.h>

#include <cmath>

#include "fake_runs.h"
#include "strategies/lesson.h"

namespace servomill::strategies::learning_strategies_test {
namespace {

using namespace fake_runs;

struct Made {
  std::unique_ptr<Strategy> strategy;
  const LearningStrategy& learner() const { return *strategy->learning(); }
};

Made made(const char* name, const std::vector<std::pair<const char*, double>>& numbers = {},
          const std::vector<std::pair<const char*, const char*>>& words = {}) {
  const Entry& entry = *find(name);
  Parameters parameters = default_parameters(entry);
  for (const auto& [key, value] : numbers) parameters.set(key, value);
  for (const auto& [key, value] : words) parameters.set(key, value);
  return {entry.make(parameters, Action::compensate, machine())};
}

TEST(Precompensation, CompensatesOnlyAndOnce) {
  const Entry& precompensation = *find("precompensation");
  EXPECT_FALSE(precompensation.imposes);
  EXPECT_TRUE(precompensation.reads_errors);
  EXPECT_FALSE(find("learning")->reads_errors) << "it sees what is left of them";
  for (const char* name : {"precompensation", "learning"}) {
    EXPECT_TRUE(find(name)->once);
    EXPECT_TRUE(find(name)->runs_program);
    EXPECT_TRUE(find(name)->corrects_following);
  }
}

TEST(Precompensation, AsksForRunsOfTheMachineThatItKnows) {
  const Made by_default = made("precompensation");
  const TrialSetup setup = by_default.learner().trials();
  EXPECT_TRUE(setup.sees_tip);
  EXPECT_FALSE(setup.on_actual);
  EXPECT_FALSE(setup.as_program);
  EXPECT_FALSE(setup.turns);
  EXPECT_EQ(setup.noise, 0.0);
  EXPECT_EQ(setup.cutoff, 100.0);
  const Made other = made("precompensation", {{"cutoff_Hz", 30.0}, {"singular_deg", 2 * deg}},
                          {{"as", "program"}, {"axes", "all"}});
  const TrialSetup changed = other.learner().trials();
  EXPECT_TRUE(changed.as_program);
  EXPECT_TRUE(changed.turns);
  EXPECT_EQ(changed.cutoff, 30.0);
  EXPECT_NEAR(changed.sigma_0, std::sin(2 * deg), kRounding);
}

TEST(LearningStrategies, ReadTheTreatmentOfLimits) {
  for (const char* name : {"precompensation", "learning"}) {
    const auto limit = [&](const char* word) {
      return made(name, {}, {{"limits", word}}).learner().trials().limit;
    };
    EXPECT_EQ(made(name).learner().trials().limit, OffsetLimit::smooth);
    EXPECT_EQ(limit("smooth"), OffsetLimit::smooth);
    EXPECT_EQ(limit("slow"), OffsetLimit::slow);
    EXPECT_EQ(limit("ignore"), OffsetLimit::ignore);
  }
}

TEST(Precompensation, EndsAtItsResidualOrAfterItsRuns) {
  const Made strategy =
      made("precompensation", {{"residual_um", 1.5 * um}, {"max_runs", 3}, {"cutoff_Hz", 50.0}});
  FakeRuns good = deviating_by({8.0, 1.5, 1.0}), poor = deviating_by({9.0, 6.0, 4.0, 2.0});
  EXPECT_EQ(rms_um(strategy.learner().learn(good)).size(), 2U);
  EXPECT_EQ(rms_um(strategy.learner().learn(poor)).size(), 3U);
  FakeRuns by_default = deviating_by({20, 19, 18, 17, 16, 15, 14, 13, 12, 11});
  EXPECT_EQ(rms_um(made("precompensation").learner().learn(by_default)).size(), 8U);
}

TEST(Learning, AsksForRunsOfTheMachineOfTheCase) {
  const TrialSetup setup = made("learning").learner().trials();
  EXPECT_TRUE(setup.sees_tip);
  EXPECT_TRUE(setup.on_actual);
  EXPECT_FALSE(setup.as_program);
  EXPECT_FALSE(setup.turns);
  EXPECT_EQ(setup.noise, 0.0);
  EXPECT_EQ(setup.cutoff, 100.0);
  const TrialSetup changed =
      made("learning", {{"noise_um", 0.2 * um}, {"cutoff_Hz", 20.0}, {"singular_deg", 3 * deg}},
           {{"sees", "scales"}, {"axes", "all"}})
          .learner()
          .trials();
  EXPECT_FALSE(changed.sees_tip);
  EXPECT_TRUE(changed.turns);
  EXPECT_EQ(changed.noise, 0.2 * um);
  EXPECT_EQ(changed.cutoff, 20.0);
  EXPECT_NEAR(changed.sigma_0, std::sin(3 * deg), kRounding);
}

// A constant deviation of 4 um: u = r (u + g / 1.0025 (-4 um)) per update.
TEST(Learning, UpdatesAsOftenAsItsKeySaysWithGainAndForgetting) {
  const Made strategy = made("learning", {{"updates", 3}, {"gain", 0.5}, {"forgetting", 0.2}});
  FakeRuns runs = deviating_by({4.0});
  const Lesson lesson = strategy.learner().learn(runs);
  EXPECT_EQ(lesson.trials.size(), 3U);
  double u = 0.0;
  for (int k = 0; k < 3; ++k) u = 0.8 * (u - 0.5 / 1.0025 * 4.0);
  EXPECT_NEAR(lesson.offset->offset[kRows / 2][1] / um, u, 1e-9);
  EXPECT_EQ(made("learning").learner().learn(runs).trials.size(), 5U);
}

TEST(LearningStrategies, DisplaceNothingBeforeTheyHaveLearnt) {
  for (const char* name : {"precompensation", "learning"}) {
    const Made untaught = made(name);
    EXPECT_EQ(untaught.strategy->setpoint(), nullptr);
    EXPECT_FALSE(untaught.strategy->rewrites());
    EXPECT_FALSE(untaught.strategy->displaces_feedback());
    EXPECT_FALSE(untaught.strategy->displaces_rotary());
    EXPECT_TRUE(untaught.strategy->rewrites_tip_moves());
  }
  EXPECT_EQ(find("none")->make({}, Action::compensate, machine())->learning(), nullptr);
}

// Y is offset by 10 um per 20 mm of path.
std::shared_ptr<const PathOffset> inclined() {
  FakeRuns runs = deviating_by({1.0});
  PathOffset out{runs.times(), std::vector<Joints>(kRows, Joints::Zero())};
  for (std::size_t n = 0; n < kRows; ++n) {
    out.offset[n][1] = runs.times()->s[n * kEvery] * 10 * um / (20 * mm);
  }
  return std::make_shared<const PathOffset>(std::move(out));
}

TEST(LearningStrategies, OffsetTheSetpointAlongThePath) {
  const auto offset = inclined();
  for (const char* name : {"precompensation", "learning"}) {
    const auto taught = made(name).learner().with_offset(offset);
    EXPECT_EQ(taught->learning(), nullptr) << "it does not learn again";
    EXPECT_FALSE(taught->rewrites());
    const auto part = taught->setpoint();
    ASSERT_NE(part, nullptr);
    EXPECT_EQ(part->entry().entry, EntryPoint::feed_forward);
    Reading now;
    part->advance(now);
    now.t = 1.0;
    now.s = 20 * mm;
    EXPECT_NEAR(part->advance(now)[1], 10 * um, 1e-6 * um);
  }
}

// Points of the blocks along X lie on the offset line.
TEST(Precompensation, WritesTheOffsetIntoTheProgram) {
  Move move;
  move.feed = 0.05;
  move.s_begin = 0.0;
  move.s_end = 10 * mm;
  move.end = move.end_machine = machine().layout.words(Joints::Unit(0) * 10 * mm);
  Move next = move;
  next.s_begin = 10 * mm;
  next.s_end = 30 * mm;
  next.end = next.end_machine = machine().layout.words(Joints::Unit(0) * 30 * mm);
  next.line = 7;
  const auto strategy = made("precompensation", {}, {{"as", "program"}});
  const auto taught = strategy.learner().with_offset(inclined());
  EXPECT_EQ(taught->setpoint(), nullptr);
  ASSERT_TRUE(taught->rewrites());
  EXPECT_TRUE(taught->rewrites_tip_moves());
  EXPECT_FALSE(taught->displaces_rotary());
  Move stand = move;
  stand.kind = MoveKind::rapid;
  stand.s_end = 0.0;
  stand.end = stand.end_machine = AxisWords::Zero();
  const std::vector<Move> blocks = rewritten_moves(*taught, {stand, move, next});
  ASSERT_GT(blocks.size(), 3U);
  EXPECT_NEAR(layout().joints(blocks.back().end_machine)[1], 15 * um, 1e-6 * um);
  for (const Move& block : blocks) {
    const Joints Q = layout().joints(block.end_machine);
    EXPECT_NEAR(Q[1], inclined()->at_place(block.s_end)[1], 1e-6 * um) << block.s_end;
    EXPECT_NEAR(Q[0], block.s_end, 1e-9) << block.s_end;
  }
  EXPECT_EQ(blocks.back().line, 7);
  EXPECT_EQ(blocks.back().s_end, 30 * mm);
  const auto turning = made("precompensation", {}, {{"as", "program"}, {"axes", "all"}});
  EXPECT_TRUE(turning.learner().with_offset(inclined())->displaces_rotary());
}

}  // namespace
}  // namespace servomill::strategies::learning_strategies_test

// Run after run of a program: which offset is tried next, which is kept, and what is refused.
#include "strategies/iterative_learning.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fake_runs.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::strategies::iterative_learning_test {
namespace {

using namespace fake_runs;

LearningPlan plan_of(int runs, double tolerance = 0.0, bool takes_best = true) {
  LearningPlan plan;
  plan.filter.cutoff = 100.0;
  plan.setup.runs = runs;
  plan.tolerance = tolerance;
  plan.takes_best = takes_best;
  return plan;
}

std::string refusal(const LearningPlan& plan, FakeRuns& runs) {
  try {
    learn(plan, layout(), runs);
  } catch (const InputError& error) {
    EXPECT_EQ(error.faults().front().place, Place{});
    return error.what();
  }
  return "taken";
}

TEST(LearningBestRun, EndsWhereARunIsWorse) {
  FakeRuns runs = deviating_by({10.0, 4.0, 3.0, 5.0, 1.0});
  const Lesson lesson = learn(plan_of(8), layout(), runs);
  EXPECT_EQ(runs.runs.size(), 4U);
  ASSERT_EQ(lesson.trials.size(), 4U);
  EXPECT_EQ(lesson.offset, runs.runs[2]);
  for (std::size_t k = 0; k < 4; ++k) {
    const double size = std::vector{10.0, 4.0, 3.0, 5.0}[k];
    EXPECT_NEAR(lesson.trials[k].rms, size * um, kRounding * um);
    EXPECT_NEAR(lesson.trials[k].largest, size * um, kRounding * um);
  }
}

TEST(LearningBestRun, EndsWhereARunIsHardlyBetterAndTakesIt) {
  FakeRuns hardly = deviating_by({10.0, 5.0, 4.91, 1.0}),
           enough = deviating_by({10.0, 5.0, 4.89, 1.0, 2.0});
  const Lesson of_hardly = learn(plan_of(8), layout(), hardly);
  ASSERT_EQ(hardly.runs.size(), 3U) << "2 per cent better are needed to go on";
  EXPECT_EQ(of_hardly.offset, hardly.runs[2]);
  const Lesson of_enough = learn(plan_of(8), layout(), enough);
  ASSERT_EQ(enough.runs.size(), 5U);
  EXPECT_EQ(of_enough.offset, enough.runs[3]);
}

TEST(LearningBestRun, EndsWhereTheLargestDeviationIsWithinTheTolerance) {
  for (const double at : {2.0, 2.001}) {  // um
    FakeRuns runs([&](int run, std::size_t row, const Joints&) {
      const double size = run == 1 ? 5.0 : (run == 2 && row == 100 ? at : 1.0 / run);
      return Joints(Joints::Unit(2) * size * um);
    });
    const Lesson lesson = learn(plan_of(3, 2.0 * um), layout(), runs);
    EXPECT_EQ(runs.runs.size(), at > 2.0 ? 3U : 2U) << "the rms is below it in both";
    EXPECT_EQ(lesson.offset, runs.runs.back());
    EXPECT_NEAR(lesson.trials[1].largest, at * um, kRounding * um);
  }
}

TEST(LearningBestRun, WithinTheToleranceNeedsNoOffset) {
  FakeRuns runs = deviating_by({0.5, 0.1});
  const Lesson lesson = learn(plan_of(8, 0.5 * um), layout(), runs);
  EXPECT_EQ(runs.runs.size(), 1U);
  EXPECT_TRUE(runs.asked.empty());
  ASSERT_EQ(lesson.offset->offset.size(), kRows);
  for (const Joints& one : lesson.offset->offset) EXPECT_EQ(one, Joints::Zero());
}

TEST(LearningBestRun, IsThatOfTheRunsThatMayTakePlace) {
  FakeRuns runs = deviating_by({8.0, 4.0, 2.0, 1.0});
  const Lesson lesson = learn(plan_of(3), layout(), runs);
  ASSERT_EQ(runs.runs.size(), 3U);
  EXPECT_EQ(lesson.offset, runs.runs[2]);
}

// The offset that the last run has taught was never run itself.
TEST(LearningAllRuns, ReturnsTheOffsetAfterTheLastOneHoweverTheyWere) {
  FakeRuns runs = deviating_by({1.0, 5.0, 0.0, 7.0});
  const Lesson lesson = learn(plan_of(4, 100 * um, false), layout(), runs);
  EXPECT_EQ(runs.runs.size(), 4U);
  EXPECT_EQ(lesson.trials.size(), 4U);
  ASSERT_EQ(runs.asked.size(), 4U);
  EXPECT_EQ(lesson.offset->offset, runs.asked.back());
  EXPECT_EQ(std::count(runs.runs.begin(), runs.runs.end(), lesson.offset), 0);
  EXPECT_EQ(lesson.offset->times, runs.times());
}

// rms and largest norm of X, Y and Z in feed motion.
TEST(LearningFigures, AreOfLinearAxesInFeedMotion) {
  FakeRuns runs([](int, std::size_t row, const Joints&) {
    Joints out;
    out << 3 * um, 0.0, 4 * um, 1.0, 1.0;
    return Joints(row < 100 ? out : row < 200 ? 3.0 * out : 100.0 * out);
  });
  for (std::size_t n = 200; n < kRows; ++n) runs.feed[n] = false;
  const Lesson lesson = learn(plan_of(1), layout(), runs);
  EXPECT_NEAR(lesson.trials.front().rms, 5 * um * std::sqrt(5.0), kRounding * um);
  EXPECT_NEAR(lesson.trials.front().largest, 15 * um, kRounding * um);
  runs.feed.assign(kRows, false);
  const TrialFigures none = learn(plan_of(1), layout(), runs).trials.front();
  EXPECT_EQ(none.rms, 0.0);
  EXPECT_EQ(none.largest, 0.0);
}

double swing(std::size_t row) {
  return std::sin(2.0 * std::numbers::pi * 20.0 * static_cast<double>(row) * kH * kEvery);
}

// The next offset is that of the filter for the negative deviation; only what is admitted is run.
TEST(LearningOffsets, AreThoseOfTheFilterAsFarAsTheyAreAdmitted) {
  FakeRuns runs([](int run, std::size_t row, const Joints&) {
    return Joints(Joints::Constant(2 * um * swing(row) / run));
  });
  runs.known = [](int joint, double f) { return (joint + 1.0) / Complex(1.0, f / 80.0); };
  runs.actual = runs.known;
  runs.offset_joints = {0, 1, 4};
  runs.admitted = 0.8 * um;
  LearningPlan plan = plan_of(3, 0.0, false);
  plan.filter = {.cutoff = 70.0, .gain = 0.8, .remembering = 0.9};
  const Lesson lesson = learn(plan, layout(), runs);
  ASSERT_EQ(runs.asked.size(), 3U);
  std::vector<Joints> u(kRows, Joints::Zero());
  for (int run = 1; run <= 3; ++run) {
    const auto k = static_cast<std::size_t>(run) - 1;
    EXPECT_EQ(runs.runs[k]->offset, u);
    std::vector<Joints> e;
    for (std::size_t n = 0; n < kRows; ++n) {
      e.push_back(-Joints::Constant(2 * um * swing(n) / run));
    }
    u = next_offset(u, e, kH * kEvery, plan.filter, {0, 1, 4}, runs.known);
    EXPECT_EQ(runs.asked[k], u);
    double largest = 0.0;
    for (Joints& one : u) {
      largest = std::max(largest, one.lpNorm<Eigen::Infinity>());
      one = one.cwiseMin(runs.admitted).cwiseMax(-runs.admitted);
    }
    EXPECT_GT(largest, runs.admitted);
  }
  EXPECT_EQ(lesson.offset->offset, u);
}

// A machine that follows and repeats its error: 0.25 % of it are left by each run.
TEST(LearningOffsets, RemoveWhatRepeats) {
  FakeRuns runs([](int, std::size_t row, const Joints& offset) {
    const double inside = std::min(
        1.0,
        std::min<double>(static_cast<double>(row), static_cast<double>(kRows - 1 - row)) / 100.0);
    return Joints(offset + Joints::Unit(0) * 5 * um * inside * inside * inside *
                               (10.0 + inside * (6.0 * inside - 15.0)));
  });
  const std::vector<double> rms = rms_um(learn(plan_of(3), layout(), runs));
  ASSERT_EQ(rms.size(), 3U);
  EXPECT_GT(rms[0], 3.0);
  EXPECT_LT(rms[1], 0.003 * rms[0]);
  EXPECT_LT(rms[2], 0.1 * rms[1]);
}

// |Q (1 - L P_a)| = 2.006 / 1.0025 - 1 of an axis that does 2.006 times what it is known to do.
TEST(Learning, RefusesAFilterThatDoesNotContract) {
  FakeRuns runs = deviating_by({1.0});
  runs.actual = [](int, double) { return 2.004; };
  EXPECT_EQ(refusal(plan_of(1), runs), "taken");
  runs.actual = [](int, double) { return 2.006; };
  EXPECT_EQ(refusal(plan_of(1), runs),
            "<input>: error: cutoff_Hz: the filter does not contract: at 0.5 Hz the next run would "
            "have 1.00 times the error of axis X; lower cutoff_Hz or the gain");
  EXPECT_EQ(runs.runs.size(), 1U) << "it is refused before the program runs";
}

// A delay of 10 ms: of Q |1 - exp(-2 pi j f 10 ms) / 1.0025| the largest is 1.897, at 46.2 Hz. With
// a lower cutoff it contracts, and where half is forgotten.
TEST(Learning, RefusesWithFrequencyAndAxisWhereItIsWorst) {
  FakeRuns runs = deviating_by({1.0});
  runs.actual = [](int joint, double f) {
    return joint == 2 ? std::polar(1.0, -std::numbers::pi * f / 50.0) : 1.0;
  };
  LearningPlan plan = plan_of(1);
  EXPECT_EQ(
      refusal(plan, runs),
      "<input>: error: cutoff_Hz: the filter does not contract: at 46.2 Hz the next run would "
      "have 1.90 times the error of axis Z; lower cutoff_Hz or the gain");
  plan.filter.cutoff = 10.0;
  EXPECT_EQ(refusal(plan, runs), "taken");
  plan.filter.cutoff = 100.0;
  plan.filter.remembering = 0.5;
  EXPECT_EQ(refusal(plan, runs), "taken");
  runs.offset_joints = {0, 1};
  plan.filter.remembering = 1.0;
  EXPECT_EQ(refusal(plan, runs), "taken") << "Z is not offset";
}

TEST(Learning, RefusesARunThatStops) {
  FakeRuns runs = deviating_by({5.0, 3.0, 1.0});
  runs.stops_in = 2;
  for (const bool takes_best : {true, false}) {
    runs.runs.clear();
    EXPECT_EQ(refusal(plan_of(5, 0.0, takes_best), runs),
              "<input>: error: run 2 of the program stops: axis Y: following error beyond 0.1 mm "
              "at 0.3 s");
    EXPECT_EQ(runs.runs.size(), 2U);
  }
}

}  // namespace
}  // namespace servomill::strategies::iterative_learning_test

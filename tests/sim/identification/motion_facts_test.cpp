#include "sim/identification/motion_facts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tests/sim/identification/axis_experiment.h"

namespace servomill::sim::identification::motion_facts_test {
namespace {

// P over P with viscous and Coulomb friction, at constant speed:
//   Kp (Kv e - v) = b v + Fc sgn v,  e = v (1 + b / Kp) / Kv + Fc / (Kp Kv) sgn v
// Speeds of both directions, each for most of a second.
Record long_ramps() {
  Record motion;
  motion.period = 1e-3;
  double q = 0.0, v = 0.0;
  const double speeds[] = {0.05, 0.12, -0.08, -0.02, 0.1, -0.12, 0.03, -0.06};
  for (std::size_t k = 0; k < 16000; ++k) {
    const double wanted = speeds[k / 1000 % 8];
    v = v < wanted ? std::min(v + 1e-3, wanted) : std::max(v - 1e-3, wanted);
    q += v * motion.period;
    motion.command.push_back(q);
  }
  return motion;
}

TEST(MotionFacts, RampsTellTheLagTimeAndWhatFrictionLeaves) {
  const MotionFacts facts = motion_facts(recorded(long_ramps(), {small_axis(), small_loop()}));
  ASSERT_TRUE(facts.lag);
  EXPECT_EQ(facts.ramps.size(), 16u);
  // the speed of the loop is half a sample and half a mean late, which a constant speed does not
  // show
  EXPECT_NEAR(facts.lag->time, (1.0 + 200.0 / 8557.0) / 160.0, 1e-8);
  EXPECT_NEAR(facts.lag->reversal, 20.0 / (8557.0 * 160.0), 1e-10);
  EXPECT_FALSE(facts.sine);
  EXPECT_EQ(facts.reversals.size(), 11u);
}

TEST(MotionFacts, ACircleTellsGainAndLagTime) {
  Record r;
  r.period = 1e-3;
  constexpr double kFrequency = 1.3, kLag = 6.0e-3, kGain = 0.998;
  for (int k = 0; k < 3000; ++k) {
    const double w = 2.0 * std::numbers::pi * kFrequency, t = 1e-3 * k;
    r.command.push_back(0.5 + 0.1 * std::sin(w * t + 0.3));
    r.feedback.push_back(0.5 + kGain * 0.1 * std::sin(w * (t - kLag) + 0.3));
  }
  const MotionFacts facts = motion_facts(r);
  ASSERT_TRUE(facts.sine);
  EXPECT_NEAR(facts.sine->frequency, kFrequency, 1e-6);
  EXPECT_NEAR(facts.sine->amplitude, 0.1, 1e-9);
  EXPECT_NEAR(facts.sine->gain, kGain, 1e-7);
  EXPECT_NEAR(facts.sine->lag_time, kLag, 1e-8);
  EXPECT_EQ(facts.reversals.size(), 8u);
  EXPECT_NE(motion_facts_text(facts).find("circle or sine of 1.3 Hz: amplitude 100 mm, -200 um in "
                                          "the feedback, lag time 6 ms"),
            std::string::npos)
      << motion_facts_text(facts);
}

TEST(MotionFacts, OneSpeedAloneTellsNothing) {
  Record r;
  r.period = 1e-3;
  for (int k = 0; k < 500; ++k) {
    r.command.push_back(1e-4 * k);
    r.feedback.push_back(1e-4 * k - 1e-3);
  }
  EXPECT_EQ(motion_facts_text(motion_facts(r)), "");
}

}  // namespace
}  // namespace servomill::sim::identification::motion_facts_test

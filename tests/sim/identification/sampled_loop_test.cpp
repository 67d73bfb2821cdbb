#include "sim/identification/sampled_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/sim/identification/axis_experiment.h"

namespace servomill::sim::identification::sampled_loop_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// One lane.
class Loop {
 public:
  explicit Loop(const LoopSettings& settings) : loop_({settings}) {}
  void start(double position, double speed, double force) {
    loop_.start(0, position, speed, force);
  }
  double sample(double q, double y) { return sample(q, y, y); }
  double sample(double q, double y, double motor) {
    LaneArray feedback{}, behind{};
    feedback[0] = y;
    behind[0] = motor;
    loop_.sample(q, 0.0, 0.0, feedback, behind);
    return loop_.force()[0];
  }
  void set_parts(int parts) { loop_.set_parts(parts); }
  double acting(int part) const { return loop_.acting(part)[0]; }

 private:
  SampledLoop loop_;
};

TEST(SampledLoop, ProportionalLoopsGiveTheForceOfTheirFormula) {
  LoopSettings settings = small_loop();
  settings.mean_of = 1;
  Loop loop(settings);
  loop.start(0.0, 0.0, kNaN);
  loop.sample(0.0, 0.0);
  const double speed = 2e-6 / settings.period;
  EXPECT_DOUBLE_EQ(loop.sample(10e-6, 2e-6), settings.Kp * (settings.Kv * (10e-6 - 2e-6) - speed));
}

TEST(SampledLoop, TheMeanOfTwoSamplesIsDifferenced) {
  Loop loop(small_loop());
  loop.start(0.0, 0.0, kNaN);
  loop.sample(0.0, 0.0);
  loop.sample(0.0, 1e-6);
  // means (1 + 0)/2 and (3 + 1)/2 um
  const LoopSettings s = small_loop();
  EXPECT_NEAR(loop.sample(0.0, 3e-6), s.Kp * (s.Kv * -3e-6 - 1.5e-6 / s.period), 1e-9);
}

TEST(SampledLoop, ReadsTheSpeedFromTheMotorWhereThatIsItsFeedback) {
  LoopSettings s = small_loop();
  s.mean_of = 1;
  s.speed_feedback = SpeedFeedback::motor;
  Loop loop(s);
  loop.start(0.0, 0.0, kNaN);
  loop.sample(0.0, 0.0, 0.0);
  EXPECT_NEAR(loop.sample(0.0, 5e-6, 2e-6), s.Kp * (s.Kv * -5e-6 - 2e-6 / s.period), 1e-9);
}

TEST(SampledLoop, ALoopThatMovesSeesItsSpeedFromTheFirstSampleOn) {
  const LoopSettings s = small_loop();
  Loop loop(s);
  loop.start(0.1, 0.02, kNaN);
  EXPECT_NEAR(loop.sample(0.1, 0.1), -s.Kp * 0.02, 1e-9);
}

TEST(SampledLoop, TheFirstForceIsTheRecordedOne) {
  for (const double Tn : {std::numeric_limits<double>::infinity(), 0.02}) {
    LoopSettings s = small_loop();
    s.Tn = Tn;
    Loop loop(s);
    loop.start(0.1, 0.02, 7.0);
    EXPECT_NEAR(loop.sample(0.1, 0.1), 7.0, 1e-9);
  }
}

TEST(SampledLoop, TheIntegralGrowsByTheErrorAndStopsAtTheLimit) {
  LoopSettings s = small_loop();
  s.mean_of = 1;
  s.Tn = 0.05;
  Loop loop(s);
  loop.start(0.0, 0.0, kNaN);
  const double error = s.Kp * s.Kv * 1e-5;
  EXPECT_NEAR(loop.sample(1e-5, 0.0), error, 1e-9);
  EXPECT_NEAR(loop.sample(1e-5, 0.0), error * (1.0 + s.period / s.Tn), 1e-9);
  s.F_max = 0.5 * error;
  Loop limited(s);
  limited.start(0.0, 0.0, kNaN);
  limited.sample(1e-5, 0.0);
  limited.sample(1e-5, 0.0);
  EXPECT_NEAR(limited.sample(1e-6, 0.0), 0.1 * error, 1e-9) << "nothing was integrated";
}

TEST(SampledLoop, AForceActsAfterItsDeadTime) {
  LoopSettings s = small_loop();
  s.Kp = 1.0;
  s.Kv = 1.0;
  s.mean_of = 1;
  s.dead_time = 0.3 * s.period;
  Loop loop(s);
  loop.start(0.0, 0.0, kNaN);
  loop.sample(1.0, 0.0);  // 1 N
  loop.sample(3.0, 0.0);  // 3 N
  loop.set_parts(1);
  EXPECT_NEAR(loop.acting(0), 0.3 * 1.0 + 0.7 * 3.0, 1e-12);
  loop.set_parts(5);
  EXPECT_NEAR(loop.acting(0), 1.0, 1e-12);
  EXPECT_NEAR(loop.acting(1), 2.0, 1e-12) << "the force changes in its middle";
  for (const int part : {2, 3, 4}) EXPECT_NEAR(loop.acting(part), 3.0, 1e-12);
}

TEST(SampledLoop, DeadTimesOfSeveralPeriodsKeepTheImpulse) {
  for (const double periods : {0.0, 1.0, 2.5, kLongestDeadTime}) {
    LoopSettings s = small_loop();
    s.Kp = s.Kv = 1.0;
    s.mean_of = 1;
    s.dead_time = periods * s.period;
    Loop loop(s);
    loop.set_parts(1);
    loop.start(0.0, 0.0, kNaN);
    double impulse = 0.0;
    loop.sample(1.0, 0.0);
    for (int n = 0; n < 12; ++n) {
      impulse += loop.acting(0);
      loop.sample(0.0, 0.0);
    }
    EXPECT_NEAR(impulse, 1.0, 1e-12) << periods;
  }
}

}  // namespace
}  // namespace servomill::sim::identification::sampled_loop_test

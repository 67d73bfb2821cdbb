#include "controllers/servo/position_feedback.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "controllers/servo/cascade.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers::position_feedback_test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kTp = 0.2e-3;       // s, CC 424
constexpr double kKv = 250.0 / 3.0;  // 1/s
constexpr double kA = 150.0 * um;
constexpr double kOmega = 2.0 * kPi * 23.2e-3 / 50e-3;  // rad/s: 23.2 mm/s over L = 50 mm

enum class Entry { encoder, table };

// Greatest distance between the displacement that is wanted and the one that a lag-mode position
// loop over an ideal velocity loop makes, once it repeats.
double lag(const PositionFeedbackParams& p, Entry entry) {
  CascadeParams loop;
  loop.Kv = kKv;
  CascadeState s;
  PositionFeedbackState feedback;
  double x = 0.0, greatest = 0.0;
  const double period = 2.0 * kPi / kOmega;
  for (int k = 0; k * kTp < 2.0 * period; ++k) {
    const double d = kA * std::sin(kOmega * k * kTp);
    const double wanted = entry == Entry::table ? d : -d;
    if (k * kTp > period) greatest = std::max(greatest, std::abs(wanted - x));
    const double y = position_feedback(p, feedback, x, entry == Entry::encoder ? x + d : x);
    position_loop(loop, s, entry == Entry::table ? d : 0.0, y, 0.0, 0.0);
    x += kTp * s.v_cmd;
  }
  return greatest;
}

// The same in closed form: A |1 - G LP| with the loop G = Kv Tp / (z - 1 + Kv Tp) and the low-pass
// LP = g / (1 - (1 - g) / z).
double closed_form(double gain) {
  const std::complex<double> z = std::polar(1.0, kOmega * kTp);
  const auto G = kKv * kTp / (z - 1.0 + kKv * kTp), LP = gain / (1.0 - (1.0 - gain) / z);
  return kA * std::abs(1.0 - G * LP);
}

// DOMAIN.md 0.1 and 0.3: a simulation of its own, numbers to two digits.
TEST(CrossoverFilter, HasTheKnownLagOfAnInjectedOffset) {
  constexpr double kTwoDigits = 0.01 * um;
  EXPECT_NEAR(lag(scale_feedback(), Entry::encoder), 5.24 * um, kTwoDigits);
  EXPECT_NEAR(lag(crossover_feedback(80.0, kTp), Entry::encoder), 6.07 * um, kTwoDigits);
  EXPECT_NEAR(lag(crossover_feedback(40.0, kTp), Entry::encoder), 6.94 * um, kTwoDigits);
  EXPECT_NEAR(lag(crossover_feedback(20.0, kTp), Entry::encoder), 8.68 * um, kTwoDigits);
}

TEST(CrossoverFilter, LagsAsItsTransferFunctionSays) {
  constexpr double kSampling =
      1e-7;  // of the lag: the sine is met within (w Tp)^2 / 8, start fades
  EXPECT_NEAR(lag(scale_feedback(), Entry::encoder), closed_form(1.0), kSampling * kA);
  for (const double f : {80.0, 40.0, 20.0, 5.0}) {
    EXPECT_NEAR(lag(crossover_feedback(f, kTp), Entry::encoder),
                closed_form(crossover_gain(f, kTp)), kSampling * kA)
        << f << " Hz";
  }
}

// A w (1/Kv + 1/(2 pi f) - Tp/2): what half a period takes off is just what separates the known
// answers (6.07) from the continuous filter (6.12).
TEST(CrossoverFilter, LagsByTheSumOfTheDelays) {
  for (const double f : {80.0, 40.0, 20.0}) {
    const double T = 1.0 / kKv + 1.0 / (2.0 * kPi * f) - kTp / 2.0;
    EXPECT_NEAR(lag(crossover_feedback(f, kTp), Entry::encoder), kA * kOmega * T,
                1e-3 * kA * kOmega * T)
        << f << " Hz";
  }
}

TEST(CrossoverFilter, DoesNotTouchATableValue) {
  const double plain = lag(scale_feedback(), Entry::table);
  EXPECT_NEAR(plain, 5.24 * um, 0.01 * um);
  for (const double f : {80.0, 40.0, 20.0}) {
    EXPECT_NEAR(lag(crossover_feedback(f, kTp), Entry::table), plain, 1e-18) << f << " Hz";
  }
}

TEST(CrossoverFilter, StandsStillAtTheStartAndGoesOverToTheScale) {
  const PositionFeedbackParams p = crossover_feedback(40.0, kTp);
  PositionFeedbackState s = standing_at(p, 0.1, 0.4);
  for (int k = 0; k < 100; ++k) EXPECT_DOUBLE_EQ(position_feedback(p, s, 0.1, 0.4), 0.4);
  for (int k = 1; k <= 100; ++k) {  // a step of the scale alone arrives with 1 - exp(-2 pi f t)
    EXPECT_NEAR(position_feedback(p, s, 0.1, 0.5),
                0.4 + 0.1 * (1.0 - std::exp(-2.0 * kPi * 40.0 * k * kTp)), 1e-15);
  }
}

TEST(CrossoverFilter, FollowsTheMotorAtOnce) {
  const PositionFeedbackParams p = crossover_feedback(40.0, kTp);
  PositionFeedbackState s = standing_at(p, 0.0, 0.0);
  EXPECT_NEAR(position_feedback(p, s, 1.0, 0.0), std::exp(-2.0 * kPi * 40.0 * kTp), 1e-15);
}

TEST(MotorFeedback, NeverLooksAtTheScaleAgain) {
  PositionFeedbackState s = standing_at(motor_feedback(), 0.1, 0.4);
  EXPECT_EQ(position_feedback(motor_feedback(), s, 0.2, 17.0), 0.2 + (0.4 - 0.1));
}

TEST(ScaleFeedback, IsTheScaleBitForBit) {
  PositionFeedbackState s = standing_at(scale_feedback(), 0.1, 0.3);
  EXPECT_EQ(position_feedback(scale_feedback(), s, 0.2, 1.0 / 3.0), 1.0 / 3.0);
}

}  // namespace
}  // namespace servomill::controllers::position_feedback_test

/// The predictive virtual encoder against closed forms: constant velocity, sinusoids, rotary axes,
/// friction; and its lanes.
#include "strategies/predictive_encoder.h"

#include <gtest/gtest.h>

#include <limits>
#include <numbers>

#include "strategies/bristle_model.h"
#include "strategies/feedback.h"
#include "strategies/motion_observer.h"
#include "tests/strategies/known_loops.h"

namespace servomill::strategies::predictive_encoder_test {
namespace {

using Complex = std::complex<double>;

constexpr double kSlope = 0.01;  // m/m: EYX = kSlope x
constexpr double kTwoPi = 2.0 * std::numbers::pi;

IdentifiedMachine identified_over_x(const plant::ErrorFunction& error) {
  plant::ErrorModel errors;
  errors.component({Axis::Y, Axis::X}) = error;
  IdentifiedMachine identified = identified_with(errors);
  identified.reference.setZero();  // d is then along Y alone
  identified.loops = known_loops({});
  return identified;
}

Parameters parameters_of(std::string_view prediction, std::string_view axes = "linear") {
  Parameters p = default_parameters(feedback_entry());
  p.set("prediction", prediction);
  p.set("axes", axes);
  for (const char* limit : {"max_um", "max_rate_mm_per_s", "max_mrad", "max_rate_mrad_per_s"}) {
    p.set(limit, 1e9);
  }
  return p;
}

Acting predicting(const IdentifiedMachine& identified, std::string_view prediction,
                  std::string_view axes = "linear") {
  return make_acting(feedback_entry(), parameters_of(prediction, axes), Action::compensate,
                     identified);
}

Joints at_x(double x) {
  Joints Q = Joints::Zero();
  Q[0] = x;
  return Q;
}

// A ramp that is fed back through the inverse of a lag is ahead by the lag.
TEST(PredictiveEncoder, IsAheadByTheLagOfTheLoopAtConstantVelocity) {
  const IdentifiedMachine identified = identified_over_x(plant::polynomial({0.0, kSlope}));
  const Acting acting = predicting(identified, "loop");
  const double v = 20.0 * mm;  // m/s
  acting.feedback->settle(at_x(0.0));
  double x = 0.0, d = 0.0;
  for (int n = 1; n < 6000; ++n) {
    x = n * v * kModelPeriod;
    d = acting.feedback->advance(at_x(x))[1];
  }
  const double found_at = x - v * kModelPeriod;  // acts a period later
  const double lag = lag_of(*identified.loops->responses[1]);
  const double share = 1e-3;  // of the way ahead: of the fit, and of slopes that are not 0
  EXPECT_NEAR(d, kSlope * (found_at + v * lag), share * kSlope * v * lag);
  // at standstill it is where it is, once the pole of the inverse has decayed
  for (int n = 0; n < 12'000; ++n) d = acting.feedback->advance(at_x(x))[1];
  EXPECT_NEAR(d, kSlope * x, 1e-12);
}

// X runs over an error of Y that is a sine: what the loop makes of the displacement is that sine.
TEST(PredictiveEncoder, DisplacesTheAxisByASineAsTheExactResponsePredicts) {
  const double period = 10.0 * mm, amplitude = 20.0 * um;
  const IdentifiedMachine identified = identified_over_x(plant::harmonic(amplitude, period));
  const KnownLoop loop;
  const Prediction prediction =
      prediction_of(identified, VirtualEncoderParams{}, kTwoPi * 50.0, false);
  for (const double f : {0.4, 2.0, 5.0}) {
    const double w = kTwoPi * f, v = f * period;
    const Acting acting = predicting(identified, "loop");
    acting.feedback->settle(at_x(0.0));
    Complex sum = 0.0;
    const int settled = 20'000, count = static_cast<int>(std::lround(5.0 / (f * kModelPeriod)));
    for (int n = 1; n <= settled + count; ++n) {
      const double t = n * kModelPeriod;
      const double d = acting.feedback->advance(at_x(v * t))[1];
      // found one period before
      if (n > settled) sum += d * std::polar(2.0 / count, -w * (t - kModelPeriod));
    }
    const Complex of_sine(0.0, -amplitude);  // of sin(w t)
    const Complex H = response(prediction.inverse[1], prediction.times, kModelPeriod, w);
    EXPECT_LT(std::abs(sum / of_sine - H), 2e-3) << f << " Hz";
    EXPECT_LT(std::abs(loop.P(w) * sum / of_sine - 1.0), f < 5.0 ? 2e-3 : 5e-3) << f << " Hz";
  }
}

// Errors over a rotary axis that is not displaced: it does not stand still.
TEST(PredictiveEncoder, LooksAheadAlongRotaryAxesThatAreNotDisplaced) {
  plant::ErrorModel errors;
  errors.component({Axis::Y, Axis::C}) = plant::polynomial({0.0, 30.0 * um});  // per rad
  IdentifiedMachine identified = identified_with(errors);
  identified.loops = known_loops({});
  const Acting acting = predicting(identified, "loop");
  const Acting still = predicting(identified, "lag");
  const double rate = 0.5;  // rad/s
  Joints Q = Joints::Zero();
  acting.feedback->settle(Q);
  still.feedback->settle(Q);
  Joints d, here;
  for (int n = 0; n < 4000; ++n) {
    Q[4] = n * rate * kModelPeriod;
    d = acting.feedback->advance(Q);
    here = still.feedback->advance(Q);
  }
  Joints ahead = Q;
  ahead[4] += rate * (lag_of(*identified.loops->responses[1]) - kModelPeriod);
  const Joints wanted = predicting(identified, "loop").feedback->settle(ahead);
  EXPECT_NEAR(d[1], wanted[1], 2e-3 * std::abs(wanted[1] - here[1]) + 1e-12);
  EXPECT_GT(std::abs(wanted[1] - here[1]), 0.1 * um);
}

// A displaced rotary axis is fed back through the inverse of its own loop.
TEST(PredictiveEncoder, DisplacesRotaryAxesAhead) {
  plant::ErrorModel errors;
  errors.component({Axis::C, Axis::C}) = plant::polynomial({0.0, 1e-3});  // rad/rad
  IdentifiedMachine identified = identified_with(errors);
  identified.loops = known_loops({});
  const Acting acting = predicting(identified, "loop", "all");
  Joints Q = identified.reference;
  acting.feedback->settle(Q);
  const double rate = 0.5;
  Joints d;
  const double from = Q[4];
  for (int n = 0; n < 6000; ++n) {
    Q[4] = from + n * rate * kModelPeriod;
    d = acting.feedback->advance(Q);
  }
  Joints ahead = Q;
  ahead[4] += rate * (lag_of(*identified.loops->responses[4]) - kModelPeriod);
  const Joints wanted = predicting(identified, "loop", "all").feedback->settle(ahead);
  EXPECT_GT(std::abs(wanted[4]), 1e-6);
  EXPECT_NEAR(d[4], wanted[4], 2e-3 * 1e-3 * rate / 112.0);
}

// Y is displaced by a sine while it stands: the force of its bristles, through C.
TEST(PredictiveEncoder, AddsWhatTheFrictionOfTheDisplacementCosts) {
  const double period = 62.0 * mm, amplitude = 150.0 * um;
  IdentifiedMachine identified = identified_over_x(plant::harmonic(amplitude, period));
  auto loops = known_loops({});
  loops->friction[1] = {.Fc_positive = 450.0,
                        .Fc_negative = 450.0,
                        .Fs_positive = 560.0,
                        .Fs_negative = 560.0,
                        .vs = 2e-3,
                        .sigma0 = 5e7,
                        .sigma1 = 3e4};
  identified.loops = loops;
  const Acting with = predicting(identified, "observer"), without = predicting(identified, "loop");
  const ForceInverse C = force_inverse_of(*loops->responses[1], kModelPeriod);
  Joints Q = at_x(0.0);
  Joints d = with.feedback->settle(Q), d_0 = without.feedback->settle(Q);
  EXPECT_EQ(d, d_0);
  ForceInverseState state;
  double z = 0.0, largest = 0.0, off = 0.0, before = 0.0;
  constexpr int kStarted = 50'000;  // past a reversal since X has begun to move at once
  for (int n = 1; n < 100'000; ++n) {
    // the axis is displaced as wanted: by -d of its position
    const double v = 23.2 * mm, x = n * v * kModelPeriod, k = kTwoPi / period;
    Q[0] = x;
    Q[1] = -amplitude * std::sin(k * x);
    d = with.feedback->advance(Q);
    d_0 = without.feedback->advance(Q);
    if (n > kStarted) {
      off = std::max(off, std::abs(d[1] - d_0[1] + before));
      largest = std::max(largest, std::abs(before));
    }
    before =
        state.advance(C, advance_bristles(loops->friction[1], -amplitude * k * v * std::cos(k * x),
                                          kModelPeriod, z));
  }
  EXPECT_GT(largest, 1.0 * um);
  // the velocity is derived from the model between previews; 1 %
  EXPECT_LT(off, 0.01 * largest);
}

TEST(PredictiveEncoder, AtStandstillIsTheDisplacementOfTheModel) {
  plant::Uniform random(7);
  IdentifiedMachine identified = identified_with(plant::random_errors(random, 20e-6));
  identified.loops = known_loops({});
  for (const std::string_view axes : {"linear", "all"}) {
    const Acting acting = predicting(identified, "observer", axes);
    const Acting plain = predicting(identified, "lag", axes);
    const Joints d = plain.feedback->settle(identified.reference);
    EXPECT_EQ(acting.feedback->settle(identified.reference), d);
    for (int n = 0; n < 1000; ++n) {
      constexpr double kRounding = 1e-14;  // m, rad
      const Joints now = acting.feedback->advance(identified.reference);
      EXPECT_LT((now - d).cwiseAbs().maxCoeff(), kRounding) << n;
    }
  }
}

TEST(PredictiveEncoder, GivesTheSameBitsTogetherAndAlone) {
  plant::Uniform random(23);
  IdentifiedMachine identified = identified_with(plant::random_errors(random, 50e-6));
  auto loops = known_loops({});
  loops->friction.fill({.Fc_positive = 450.0,
                        .Fc_negative = 430.0,
                        .Fs_positive = 560.0,
                        .Fs_negative = 500.0,
                        .sigma0 = 5e7});
  identified.loops = loops;
  constexpr LaneFlags kRuns = {true, true, false, true, true, true, false, true};
  for (const std::string_view prediction : {"loop", "observer"}) {
    for (const std::string_view axes : {"linear", "all"}) {
      const auto strategy =
          feedback_entry().make(parameters_of(prediction, axes), Action::compensate, identified);
      const auto together = strategy->feedback(kModelPeriod);
      const auto in_turn = strategy->feedback(kModelPeriod);
      std::vector<std::unique_ptr<FeedbackPart>> alone;
      std::vector<Joints> Q(kLaneWidth, identified.reference);
      JointLanes Q_lanes, waiting{};
      for (LaneArray& of_joint : Q_lanes) of_joint.fill(std::numeric_limits<double>::quiet_NaN());
      for (std::size_t run = 0; run < kLaneWidth; ++run) {
        alone.push_back(strategy->feedback(kModelPeriod));
        if (!kRuns[run]) continue;
        for (int j = 0; j < kLinearJoints; ++j) Q[run][j] = 0.15 * random();
        EXPECT_EQ(alone[run]->settle(Q[run]), together->settle(Q[run], run));
      }
      in_turn->settle(Q[3], 5);
      for (std::size_t n = 0; n < 96; ++n) {
        for (std::size_t run = 0; run < kLaneWidth; ++run) {
          if (kRuns[run]) Q[run] += 1e-6 * Joints(random(), random(), 1.0, random(), -1.0);
          for (int j = 0; kRuns[run] && j < kJoints; ++j) Q_lanes[j][run] = Q[run][j];
        }
        const JointLanes& d = together->advance(Q_lanes, kRuns);
        for (std::size_t run = 0; run < kLaneWidth; ++run) {
          if (!kRuns[run]) continue;
          const Joints one = alone[run]->advance(Q[run]);
          for (int j = 0; j < kJoints; ++j) ASSERT_EQ(d[j][run], one[j]) << run << ", " << n;
        }
        for (int j = 0; j < kJoints; ++j) waiting[j][n % kLaneWidth] = Q[3][j];
        if (n % kLaneWidth != kLaneWidth - 1) continue;
        const Joints eight = in_turn->advance(waiting, kLaneWidth, 5);
        for (int j = 0; j < kJoints; ++j) ASSERT_EQ(d[j][3], eight[j]) << n;
      }
    }
  }
}

TEST(PredictiveEncoder, ReportsItsSaturation) {
  const IdentifiedMachine identified = identified_over_x(plant::polynomial({0.0, kSlope}));
  Parameters parameters = parameters_of("loop");
  parameters.set("max_um", 10.1 * um);
  const Acting acting = make_acting(feedback_entry(), parameters, Action::compensate, identified);
  EXPECT_EQ(acting.feedback->settle(at_x(50.0 * mm))[1], 10.1 * um);
  const auto found = acting.feedback->saturations(0);
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].joint, 1);
  EXPECT_FALSE(found[0].of_rate);
}

// Ideal axes have no loops: displacements are fed back as they are.
TEST(PredictiveEncoder, OfIdealAxesLooksNowhereAhead) {
  IdentifiedMachine identified = identified_over_x(plant::polynomial({0.0, kSlope}));
  identified.loops = nullptr;
  const Acting acting = predicting(identified, "observer");
  acting.feedback->settle(at_x(0.0));
  double d = 0.0, x = 0.0;
  for (int n = 1; n < 4000; ++n) {
    x = n * 1e-6;
    d = acting.feedback->advance(at_x(x))[1];
  }
  EXPECT_NEAR(d, kSlope * (x - 1e-6), 1e-12);
  EXPECT_TRUE(acting.strategy->notes().empty());
}

}  // namespace
}  // namespace servomill::strategies::predictive_encoder_test

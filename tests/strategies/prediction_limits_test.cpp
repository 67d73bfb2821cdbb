/// Stability of the loop through the errors, and noise of the scales against random readings.
#include "strategies/prediction_limits.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

#include "plant/vocabulary/input_error.h"
#include "strategies/feedback.h"
#include "tests/strategies/known_loops.h"

namespace servomill::strategies::prediction_limits_test {
namespace {

using Gains = Eigen::Matrix<double, kJoints, kJoints>;

constexpr double kBandwidth = 2.0 * std::numbers::pi * 50.0;  // rad/s

IdentifiedMachine with_slopes(double yx, double xy) {
  plant::ErrorModel errors;
  errors.component({Axis::Y, Axis::X}) = plant::polynomial({0.0, yx});
  errors.component({Axis::X, Axis::Y}) = plant::polynomial({0.0, xy});
  IdentifiedMachine identified = identified_with(errors);
  identified.lower.tail<2>().setZero();  // the rotary axes stay
  identified.upper.tail<2>().setConstant(1e-9);
  identified.loops = known_loops({});
  return identified;
}

TEST(PredictionLimits, FindTheLargestSlopes) {
  const Gains slopes = largest_slopes(with_slopes(0.01, -0.002), {});
  EXPECT_NEAR(slopes(1, 0), 0.01, 1e-6);
  EXPECT_NEAR(slopes(0, 1), 0.002, 1e-6);
  EXPECT_NEAR(slopes(2, 0), 0.0, 1e-9);
}

TEST(PredictionLimits, TakeTheSpectralRadius) {
  Gains gains = Gains::Zero();
  EXPECT_NEAR(spectral_radius(gains), 0.0, 1e-12);
  gains(0, 0) = 0.3;
  EXPECT_NEAR(spectral_radius(gains), 0.3, 1e-9);
  gains(1, 0) = 100.0;  // one way: no loop
  EXPECT_NEAR(spectral_radius(gains), 0.3, 1e-9);
  gains.setZero();
  gains(0, 1) = 4.0;
  EXPECT_NEAR(spectral_radius(gains), 0.0, 1e-6);
  gains(1, 0) = 0.01;
  EXPECT_NEAR(spectral_radius(gains), 0.2, 1e-9);
}

TEST(PredictionLimits, RefuseErrorsThatCloseALoop) {
  Parameters parameters = default_parameters(feedback_entry());
  parameters.set("prediction", "loop");
  const auto make = [&](const IdentifiedMachine& identified) {
    return feedback_entry().make(parameters, Action::compensate, identified);
  };
  // one way round, whatever the slope is
  EXPECT_NO_THROW(make(with_slopes(0.5, 0.0)));
  EXPECT_NO_THROW(make(with_slopes(0.05, 0.05)));
  try {
    make(with_slopes(0.5, 0.5));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what())
                  .find("the loop through the identified errors may be "
                        "unstable: slope of the errors times response is "),
              std::string::npos)
        << error.what();
  }
}

TEST(PredictionLimits, RefuseTwoWaysToCompensateTheLag) {
  Parameters parameters = default_parameters(feedback_entry());
  parameters.set("prediction", "observer");
  parameters.set("extrapolation_time_ms", 5.0 * ms);
  try {
    feedback_entry().make(parameters, Action::compensate, with_slopes(0.01, 0.0));
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_EQ(error.faults().front().message,
              "extrapolation_time_ms and prediction = \"observer\" would both compensate the lag; "
              "remove one of them");
  }
}

// White noise on X of a slope of Y over X, by simulation and by the factor.
TEST(PredictionLimits, NoiseIsThatOfRandomReadings) {
  constexpr double kSlope = 0.01, kSigma = 5e-9;
  IdentifiedMachine identified = with_slopes(kSlope, 0.0);
  auto loops = known_loops({});
  loops->friction[1] = {.Fc_positive = 450.0,
                        .Fc_negative = 450.0,
                        .Fs_positive = 450.0,
                        .Fs_negative = 450.0,
                        .sigma0 = 5e7};
  identified.loops = loops;
  for (const bool friction : {false, true}) {
    const Prediction prediction =
        prediction_of(identified, VirtualEncoderParams{}, kBandwidth, friction);
    const double wanted = noise_factor(prediction, 1, kModelPeriod) * kSlope * kSigma;
    VirtualEncoderParams params;
    params.max.setConstant(1.0);
    params.max_rate.setConstant(1e3);
    const auto part = predictive_encoder(identified, params, prediction, kModelPeriod);
    std::mt19937_64 generator(3);
    std::normal_distribution<double> noise(0.0, kSigma);
    Joints Q = Joints::Zero();
    const double at_rest = part->settle(Q)[1];
    double sum = 0.0;
    constexpr int kSettled = 5000, kCount = 400'000;
    for (int n = 0; n < kSettled + kCount; ++n) {
      Q[0] = noise(generator);
      const double d = part->advance(Q)[1] - at_rest;
      if (n >= kSettled) sum += d * d;
    }
    // 24 s with a correlation of some ms: 3 % of the standard deviation
    EXPECT_NEAR(std::sqrt(sum / kCount), wanted, 0.05 * wanted) << friction;
  }
}

TEST(PredictionLimits, ReportLoopAndNoise) {
  Parameters parameters = default_parameters(feedback_entry());
  parameters.set("prediction", "loop");
  const auto strategy =
      feedback_entry().make(parameters, Action::compensate, with_slopes(0.01, 0.001));
  const auto notes = strategy->notes();
  ASSERT_EQ(notes.size(), 2U);
  EXPECT_EQ(notes[0].rfind("the loop through the identified errors has a gain of 0.00", 0), 0U)
      << notes[0];
  EXPECT_NE(notes[1].find("factor to noise times slope of the errors"), std::string::npos)
      << notes[1];
}

}  // namespace
}  // namespace servomill::strategies::prediction_limits_test

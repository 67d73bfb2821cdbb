#include "sim/identification/profile.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <cstdio>

#include "sim/identification/synthesize.h"
#include "tests/sim/identification/axis_experiment.h"

namespace servomill::sim::identification::profile_test {
namespace {

// A fit of what the experiment names to a recording of `actual`.
struct Fitted {
  Experiment experiment;
  Prediction prediction;
  Mask mask;
  Fit found;
  Uncertainty uncertainty;

  Fitted(const AxisExperiment& files, const std::string& rest)
      : experiment(read_experiment(files.write(rest))),
        prediction(experiment.document, experiment.estimates, {&experiment.records.front()}, 2),
        mask(prediction.all_samples()),
        found(fit(prediction, prediction.start(), mask)),
        uncertainty(uncertainty_of(found.jacobian, found.residual, mask)) {}

  Profile of(std::size_t parameter) const {
    return profile(prediction, found, uncertainty, mask, parameter);
  }
};

NoiseSettings noise_of(double force_rms) {
  return {.force_rms = force_rms, .force_time = 8e-3, .feedback_step = 0.0};
}

double sum_of_squares(const Fitted& fitted) { return fitted.found.residual.squaredNorm(); }

// Rise of the sum of squares at which an interval ends: t^2 C / (J'J)^-1, by a plain inverse.
double rise_of(const Fitted& fitted, Eigen::Index p) {
  const Eigen::MatrixXd inverse =
      (fitted.found.jacobian.transpose() * fitted.found.jacobian).inverse();
  const double half = fitted.uncertainty.half_width(static_cast<std::size_t>(p));
  return half * half / inverse(p, p);
}

// At one speed the loop is linear, with its dry friction, and so is the answer to a load.
TEST(Profile, OfALinearParameterIsTheIntervalOfTheCovariance) {
  const AxisExperiment files;
  Record motion;
  motion.period = 1e-3;
  for (int k = 0; k < 1500; ++k) motion.command.push_back(0.05e-3 * k);
  motion.feedback.assign(motion.command.size(), 0.0);
  AxisModel actual{small_axis(), small_loop()};
  actual.position = -0.3e-3;
  actual.speed = 0.05;
  files.write_recording(synthesize(motion, actual, noise_of(1.0)));
  const Fitted fitted(files, "[[estimate]]\nkey = \"axis.X.gravity_load\"\n");
  const Profile found = fitted.of(0);
  const double value = fitted.found.values[0], half = fitted.uncertainty.half_width(0);
  ASSERT_EQ(found.lower.end, ProfileEnd::crossed);
  ASSERT_EQ(found.upper.end, ProfileEnd::crossed);
  constexpr double kLinear = 5e-3;  // of the half-width: where the search ends
  EXPECT_NEAR(value - found.lower.value, half, kLinear * half);
  EXPECT_NEAR(found.upper.value - value, half, kLinear * half);
  EXPECT_FALSE(found.finds_better);
}

// The axis lags by 1/Kv: a gain that is known badly is known worse upwards. Fits of the other
// values, with the gain between bounds that are equal, say where the ends are.
TEST(Profile, OfANonlinearParameterIsAsymmetricAndEndsWhereFitsSay) {
  const AxisExperiment files;
  files.write_recording(synthesize(ramps(1.0), {small_axis(), small_loop()}, noise_of(400.0)));
  const std::string mass = "[[estimate]]\nkey = \"axis.X.moving_mass\"\n";
  const std::string gain = "[[estimate]]\nkey = \"loop.position_gain\"\n";
  const Fitted fitted(files, gain + mass);
  const Profile found = fitted.of(0);
  ASSERT_EQ(found.lower.end, ProfileEnd::crossed);
  ASSERT_EQ(found.upper.end, ProfileEnd::crossed);
  const double value = fitted.found.values[0];
  const double below = value - found.lower.value, above = found.upper.value - value;
  std::printf("gain %.4g - %.3g + %.3g, by the covariance +- %.3g\n", value, below, above,
              fitted.uncertainty.half_width(0));
  EXPECT_GT(above, 1.1 * below);
  for (const double end : {found.lower.value, found.upper.value}) {
    const std::string held =
        fmt::format("start = \"{0} 1/s\"\nmin = \"{0} 1/s\"\nmax = \"{0} 1/s\"\n", end);
    const double rise = sum_of_squares(Fitted(files, gain + held + mass)) - sum_of_squares(fitted);
    EXPECT_NEAR(rise / rise_of(fitted, 0), 1.0, 0.02) << end;
  }
}

TEST(Profile, EndsAtABoundWhereTheMisfitHasNotRisenEnough) {
  const AxisExperiment files;
  files.write_recording(synthesize(ramps(2.0), {small_axis(), small_loop()}, noise_of(1.5)));
  const Fitted free(files, "[[estimate]]\nkey = \"axis.X.gravity_load\"\n");
  const double value = free.found.values[0], half = free.uncertainty.half_width(0);
  const Fitted bounded(files, fmt::format("[[estimate]]\nkey = \"axis.X.gravity_load\"\n"
                                          "start = \"{} N\"\nmin = \"{} N\"\n",
                                          value, value - 0.5 * half));
  const Profile found = bounded.of(0);
  EXPECT_EQ(found.lower.end, ProfileEnd::bound);
  EXPECT_NEAR(found.lower.value, value - 0.5 * half, 1e-9);
  EXPECT_EQ(found.upper.end, ProfileEnd::crossed);
}

}  // namespace
}  // namespace servomill::sim::identification::profile_test

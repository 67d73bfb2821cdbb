#include "sim/identification/bootstrap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "sim/identification/synthesize.h"
#include "tests/sim/identification/axis_experiment.h"

namespace servomill::sim::identification::bootstrap_test {
namespace {

constexpr const char* kThree = R"(
[[estimate]]
key = "axis.X.moving_mass"
[[estimate]]
key = "axis.X.slide_viscous_friction"
[[estimate]]
key = "axis.X.gravity_load"
)";

// A fit to 4 s with a coloured force that nobody recorded, and its uncertainty.
struct Fitted {
  AxisExperiment files;
  Experiment experiment;
  Prediction prediction;
  Mask mask;
  Fit found;
  Uncertainty uncertainty;

  Fitted()
      : experiment(experiment_of(files)),
        prediction(experiment.document, experiment.estimates, {&experiment.records.front()}, 2),
        mask(prediction.all_samples()),
        found(fit(prediction, prediction.start(), mask)),
        uncertainty(uncertainty_of(found.jacobian, found.residual, mask)) {}

  static Experiment experiment_of(const AxisExperiment& files) {
    const NoiseSettings noise{.force_rms = 1.5, .force_time = 8e-3, .feedback_step = 50e-9};
    files.write_recording(synthesize(ramps(4.0), {small_axis(), small_loop()}, noise));
    return read_experiment(files.write(kThree));
  }
};

TEST(Bootstrap, AgreesWithTheCovarianceFromTheSpectrum) {
  const Fitted fitted;
  const Bootstrap found = bootstrap(fitted.found, fitted.uncertainty, fitted.mask, {400, 1});
  ASSERT_EQ(found.values.rows(), 400);
  // some fifty blocks tell a standard deviation to a tenth; both ways share only the residual
  constexpr double kBlocksAgree = 0.3;
  for (const std::size_t p : {0u, 1u, 2u}) {
    const double ratio = found.standard(p) / fitted.uncertainty.standard(p);
    std::printf("%s: bootstrap %.3g of the spectrum's, %.3g of the counted\n",
                fitted.experiment.estimates[p].keys.front().c_str(), ratio,
                found.standard(p) / fitted.uncertainty.counted[p]);
    EXPECT_NEAR(ratio, 1.0, kBlocksAgree) << p;
    const auto [low, high] = found.interval_95(p);
    EXPECT_NEAR((high - low) / (4.0 * found.standard(p)), 1.0, 0.15) << "nearly Gaussian";
    EXPECT_LT(low, fitted.found.values[p]);
    EXPECT_GT(high, fitted.found.values[p]);
  }
  EXPECT_GT(found.standard(1), 3.0 * fitted.uncertainty.counted[1])
      << "counting samples claims far too much";
}

TEST(Bootstrap, EqualSeedsGiveEqualReplicas) {
  const Fitted fitted;
  const auto values = [&](std::uint64_t seed) {
    return bootstrap(fitted.found, fitted.uncertainty, fitted.mask, {20, seed}).values;
  };
  EXPECT_EQ(values(1), values(1));
  EXPECT_NE(values(1), values(2));
}

TEST(Bootstrap, QuantilesOfFewReplicasAreUnknown) {
  Bootstrap few;
  few.values = Eigen::MatrixXd::Random(39, 1);
  EXPECT_TRUE(std::isnan(few.interval_95(0).first));
  Bootstrap one;
  one.values = Eigen::MatrixXd::Random(1, 1);
  EXPECT_TRUE(std::isnan(one.standard(0)));
  Bootstrap counted;
  counted.values = Eigen::VectorXd::LinSpaced(201, 0.0, 200.0);
  EXPECT_NEAR(counted.interval_95(0).first, 5.0, 1e-12);
  EXPECT_NEAR(counted.interval_95(0).second, 195.0, 1e-12);
}

TEST(BlockLength, OfAFirstOrderProcessFollowsItsClosedForm) {
  // c(k) = a^k: G = 2 a/(1-a)^2, g = (1+a)/(1-a), so that G/g = 2 a/(1-a^2)
  constexpr double a = 0.9;
  std::vector<double> c;
  for (int k = 0; k < 400; ++k) c.push_back(std::pow(a, k));
  const double ratio = 2.0 * a / (1.0 - a * a);
  EXPECT_EQ(block_length(c, 4000),
            static_cast<std::size_t>(std::ceil(std::cbrt(1.5 * ratio * ratio * 4000.0))));
  EXPECT_EQ(block_length({1.0}, 4000), 1u) << "white: every sample alone";
  EXPECT_EQ(block_length(c, 40), 10u) << "never more than a quarter";
}

}  // namespace
}  // namespace servomill::sim::identification::bootstrap_test

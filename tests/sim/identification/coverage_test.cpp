// Intervals of 95 % hold the truth in 95 % of many experiments: the claim of the whole method.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "sim/identification/synthesize.h"
#include "sim/identification/uncertainty.h"
#include "tests/number_of.h"
#include "tests/sim/identification/axis_experiment.h"

namespace servomill::sim::identification::coverage_test {
namespace {

constexpr const char* kSix = R"(
[[estimate]]
key = "axis.X.moving_mass"
[[estimate]]
key = "axis.X.slide_viscous_friction"
[[estimate]]
keys = ["axis.X.friction.coulomb", "axis.X.friction.coulomb_negative"]
start = "20 N"
[[estimate]]
key = "axis.X.gravity_load"
start = "-3 N"
[[estimate]]
keys = ["axis.X.friction.breakaway", "axis.X.friction.breakaway_negative"]
start = "28 N"
[[estimate]]
key = "axis.X.friction.stribeck_velocity"
start = "15 mm/s"
)";

// Quantised encoders and a force that nobody recorded; each fit begins 13 % off.
TEST(Coverage, OfSixParametersByFourSecondsWithColouredNoise) {
  const int experiments = number_of("SERVOMILL_IDENTIFICATIONS", 40);
  const AxisExperiment files;
  files.write_recording(recorded(ramps(4.0), {small_axis(), small_loop()}));
  const Experiment e = read_experiment(files.write(kSix));
  std::vector<double> truth;
  for (const Estimate& one : e.estimates) truth.push_back(one.start);
  const ModelOfValues model = model_of(e.document, e.estimates, truth);
  std::vector<Estimate> off = e.estimates;
  for (std::size_t k = 0; k < off.size(); ++k) off[k].start *= k % 2 == 0 ? 0.87 : 1.13;
  std::vector<int> inside(truth.size(), 0);
  for (int n = 0; n < experiments; ++n) {
    const NoiseSettings noise{.force_rms = 1.5,
                              .force_time = 8e-3,
                              .feedback_step = 50e-9,
                              .seed = 1000 + static_cast<std::uint64_t>(n)};
    AxisRecord record;
    record.record = synthesize(ramps(4.0), {model.machine.drives[0], model.loop}, noise);
    const Prediction prediction(e.document, off, {&record}, 2);
    const Mask mask = prediction.all_samples();
    const Fit found = fit(prediction, prediction.start(), mask);
    const Uncertainty u = uncertainty_of(found.jacobian, found.residual, mask);
    for (std::size_t k = 0; k < truth.size(); ++k) {
      inside[k] += std::abs(found.values[k] - truth[k]) <= u.half_width(k) ? 1 : 0;
    }
  }
  double pooled = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    const double share = static_cast<double>(inside[k]) / experiments;
    std::printf("%-36s %.1f %%\n", e.estimates[k].keys.front().c_str(), 100.0 * share);
    pooled += share / static_cast<double>(truth.size());
  }
  std::printf("pooled %.2f %% of %d experiments\n", 100.0 * pooled, experiments);
  // a binomial share, and intervals of one experiment that miss together
  const double scatter = std::sqrt(0.95 * 0.05 / experiments);
  EXPECT_NEAR(pooled, 0.95, 0.01 + 2.0 * scatter);
  for (std::size_t k = 0; k < truth.size(); ++k) {
    EXPECT_NEAR(static_cast<double>(inside[k]) / experiments, 0.95, 0.02 + 3.5 * scatter) << k;
  }
}

}  // namespace
}  // namespace servomill::sim::identification::coverage_test

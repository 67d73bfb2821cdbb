#include "sim/identification/synthesize.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/identification/axis_experiment.h"

namespace servomill::sim::identification::synthesize_test {
namespace {

TEST(Synthesize, WithoutNoiseItIsTheSimulation) {
  const AxisModel model{small_axis(), small_loop()};
  EXPECT_EQ(synthesize(ramps(0.5), model, {}).feedback, recorded(ramps(0.5), model).feedback);
}

TEST(Synthesize, EqualSeedsGiveEqualRecordingsAndOthersDiffer) {
  const AxisModel model{small_axis(), small_loop()};
  const NoiseSettings noise{.force_rms = 2.0, .feedback_step = 50e-9, .seed = 7};
  NoiseSettings other = noise;
  other.seed = 8;
  const Record a = synthesize(ramps(0.3), model, noise);
  EXPECT_EQ(a.feedback, synthesize(ramps(0.3), model, noise).feedback);
  EXPECT_NE(a.feedback, synthesize(ramps(0.3), model, other).feedback);
}

TEST(Synthesize, TheNoiseMovesTheAxisAsItsForceDoes) {
  AxisModel model{small_axis(), small_loop()};
  model.drive.friction = {};
  const NoiseSettings noise{.force_rms = 5.0, .force_time = 0.5};  // slow: held by the loop
  const Record a = synthesize(ramps(20.0), model, noise), b = recorded(ramps(20.0), model);
  double sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += std::pow(a.feedback[k] - b.feedback[k], 2);
  const double rms = std::sqrt(sum / static_cast<double>(a.size()));
  EXPECT_NEAR(rms, 5.0 / (8557.0 * 160.0), 0.35 * 5.0 / (8557.0 * 160.0));
  EXPECT_TRUE(a.disturbance.empty()) << "nobody records it";
}

}  // namespace
}  // namespace servomill::sim::identification::synthesize_test

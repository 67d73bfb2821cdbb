// Loops that a strategy is given: those of the exact responses, with the delays of the hardware.
#include "sim/preparation/identified_loops.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/frequency/frequency_response.h"
#include "sim/input/read_scenario.h"
#include "sim/preparation/preparation_cache.h"
#include "strategies/loop_inverse.h"

namespace servomill::sim::preparation::identified_loops_test {
namespace {

using Complex = std::complex<double>;

constexpr double kPi = std::numbers::pi, kModelPeriod = 60e-6;  // s
constexpr Tick kDelay = 1;
constexpr std::size_t kY = 1;

const model::MachineSettings& hsm600u() {
  static const model::MachineSettings kMachine =
      input::read_machine_file(SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml");
  return kMachine;
}

PreparationCache& cache() {
  static PreparationCache kCache;
  return kCache;
}

const strategies::IdentifiedLoops& loops() {
  static const auto kLoops = identified_loops(hsm600u(), kDelay, kModelPeriod, cache());
  return *kLoops;
}

TEST(IdentifiedLoops, AreTheExactResponsesAfterTheDelayOfTheHardware) {
  const strategies::LoopResponse& found = *loops().responses[kY];
  frequency::FrequencyResponse exact(hsm600u(), kY, kDelay, frequency::PositionLoop::closed);
  for (const std::size_t k : {std::size_t{0}, found.f.size() / 3, found.f.size() / 2}) {
    const double w = 2.0 * kPi * found.f[k];
    const Complex s(0.0, w);
    const Complex held = (1.0 - std::exp(-s * kModelPeriod)) / (s * kModelPeriod);
    const Complex wanted =
        std::exp(-s * kModelPeriod) * held *
        exact.at(frequency::Entry::reading, found.f[k])[index_of(frequency::AxisSignal::position)];
    EXPECT_LT(std::abs(found.displacement[k] - wanted), 1e-9) << found.f[k];
    EXPECT_EQ(found.force[k], exact.at(frequency::Entry::force,
                                       found.f[k])[index_of(frequency::AxisSignal::position)]);
  }
}

// 1/Kv, one and a half model periods of the error model, half a position period of the sampled
// reading and the signal delay; the velocity loop with its integral part adds little.
TEST(IdentifiedLoops, HaveTheLagOfTheirLoopAndOfTheirDelays) {
  const double Kv = hsm600u().nc.cascade[kY].Kv;
  const model::LoopPeriods& periods = hsm600u().nc.periods;
  const double delays =
      1.5 * kModelPeriod + periods.seconds(kDelay) + 0.5 * periods.seconds(periods.position);
  EXPECT_NEAR(strategies::lag_of(*loops().responses[kY]), 1.0 / Kv + delays, 0.02 / Kv);
  EXPECT_NEAR(std::abs(loops().responses[kY]->displacement[0] + 1.0), 0.0, 0.02);
}

TEST(IdentifiedLoops, HaveFrictionAndScalesOfTheMachine) {
  const plant::FrictionParams& actual = hsm600u().drives[kY].friction;
  EXPECT_EQ(actual.kind, plant::FrictionKind::none);
  EXPECT_EQ(loops().friction[kY], strategies::BristleFriction{});
  model::MachineSettings other = hsm600u();
  other.drives[kY].friction.kind = plant::FrictionKind::lugre;
  const strategies::BristleFriction of_bristles =
      identified_loops(other, kDelay, kModelPeriod, cache())->friction[kY];
  EXPECT_EQ(of_bristles.Fs_negative, 560.0);
  EXPECT_EQ(of_bristles.sigma0, 5e7);
  EXPECT_EQ(of_bristles.sigma1, 3e4);
  other.drives[kY].friction.kind = plant::FrictionKind::set_valued;
  const strategies::BristleFriction without =
      identified_loops(other, kDelay, kModelPeriod, cache())->friction[kY];
  EXPECT_DOUBLE_EQ(without.sigma0, 560.0 / kPresliding);
  EXPECT_EQ(without.sigma1, 0.0);
  const double step = 19.53125 * nm;
  EXPECT_NEAR(loops().reading_noise[kY], step / std::sqrt(12.0), 0.05 * step);
  EXPECT_EQ(loops().model_period, kModelPeriod);
}

TEST(IdentifiedLoops, AreComputedOnceForEachAxis) {
  model::MachineSettings other = hsm600u();
  other.drives[kY].friction.Fc_positive *= 2.0;  // of the linear loop no part
  other.nc.cascade[0].Kv *= 0.5;
  const auto again = identified_loops(other, kDelay, kModelPeriod, cache());
  EXPECT_EQ(again->responses[kY], loops().responses[kY]);
  EXPECT_NE(again->responses[0], loops().responses[0]);
}

}  // namespace
}  // namespace servomill::sim::preparation::identified_loops_test

/// Tuned gains keep what was asked for, just.
#include "sim/frequency/tuning.h"
#include "sim/frequency/axis_dynamics.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "sim/frequency/frequency_response.h"
#include "sim/frequency/measured_response.h"
#include "sim/frequency/stability.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario.h"

namespace servomill::sim::frequency::tuning_test {
namespace {

constexpr int kY = 1;
constexpr double kRounding = 2e-3;  // of a gain: four digits, rounded down

model::MachineSettings hsm600u() {
  return input::read_machine_file(SERVOMILL_SOURCE_DIR "/scenarios/machines/hsm600u.toml");
}

void use_CC422(model::MachineSettings& machine) {
  machine.nc.periods.position = 180;
  machine.nc.periods.velocity = 60;
  for (auto& cascade : machine.nc.cascade) cascade.Tv = 0.6e-3;
}

// Tuning of Y with the default margins, shared by the tests.
const Tuning& tuned_Y() {
  static const Tuning tuning = tune(hsm600u(), kY, 0, {});
  return tuning;
}

void expect_kept(const Assessment& a, const TuneSettings& wanted) {
  EXPECT_TRUE(a.stable);
  for (const Margins& m : {a.velocity, a.position}) {
    EXPECT_GE(m.gain, wanted.gain_margin);
    EXPECT_GE(m.phase, wanted.phase_margin);
  }
  EXPECT_LE(a.overshoot, wanted.overshoot);
}

TEST(Tune, KeepsTheMarginsAndLeavesNothingOver) {
  const model::MachineSettings machine = hsm600u();
  const TuneSettings wanted;
  const Tuning& t = tuned_Y();
  expect_kept(t.after, wanted);
  RecordProperty("gains", fmt::format("{:.1f} rad/s {:.2f} ms {:.1f} 1/s", t.after.gains.wv,
                                      t.after.gains.Tn / ms, t.after.gains.Kv));
  ASSERT_EQ(t.velocity.kind, Limit::Kind::phase_margin);
  EXPECT_NEAR(t.after.velocity.phase / wanted.phase_margin, 1.0, 2.0 * kRounding);
  ASSERT_EQ(t.position.kind, Limit::Kind::gain_margin);
  EXPECT_NEAR(t.after.position.gain / wanted.gain_margin, 1.0, 2.0 * kRounding);

  Gains more = t.after.gains;
  more.Kv *= 1.02;
  EXPECT_LT(assess(with_gains(machine, kY, more), kY, 0).position.gain, wanted.gain_margin);
  more = t.after.gains;
  more.wv *= 1.02;
  more.Tn /= 1.02;
  EXPECT_LT(assess(with_gains(machine, kY, more), kY, 0).velocity.phase, wanted.phase_margin);
}

// The resonance of C is sharp: between two points of a coarse grid it would rise above 1 unseen.
TEST(Tune, KeepsTheMarginsAtASharpResonance) {
  constexpr int kC = 4;
  const model::MachineSettings machine = hsm600u();
  const Tuning t = tune(machine, kC, 0, {});
  expect_kept(t.after, {});
  const double resonance = resonance_frequency(machine.drives[kC]);
  const model::MachineSettings tuned = with_gains(machine, kC, t.after.gains);
  FrequencyResponse exact(tuned, kC, 0, PositionLoop::open);
  for (const double f : logarithmic(0.8 * resonance, 1.25 * resonance, 2000)) {
    const Complex L = ratio(exact.at(Entry::velocity_command, f), AxisSignal::measured_speed,
                            AxisSignal::speed_error);
    if (std::abs(L) < 1.0) continue;
    EXPECT_GT(std::abs(std::arg(-L)), TuneSettings{}.phase_margin * (1.0 - kRounding)) << f;
  }
}

// Not nearly: what is demanded is what an assessment of the result finds, for axes of each kind,
// little damping, and the periods of either control unit.
TEST(Tune, KeepsAllThatIsDemanded) {
  struct Demand {
    int joint;
    double damping, phase;  // N s/m or N m s/rad, deg
    bool slow;              // CC422
  };
  constexpr int kX = 0, kZ = 2, kB = 3, kC = 4;
  for (const Demand& demand : {Demand{kX, 2e3, 45.0, false},
                               {kZ, 8e3, 30.0, false},
                               {kB, 20.0, 30.0, false},
                               {kC, 60.0, 45.0, true}}) {
    model::MachineSettings machine = hsm600u();
    machine.drives[static_cast<std::size_t>(demand.joint)].c = demand.damping;
    if (demand.slow) use_CC422(machine);
    TuneSettings wanted;
    wanted.phase_margin = demand.phase * deg;
    const Tuning t = tune(machine, demand.joint, 0, wanted);
    SCOPED_TRACE(fmt::format("joint {} damping {}", demand.joint, demand.damping));
    expect_kept(t.after, wanted);
    EXPECT_TRUE(keeps(t.after, wanted));
    constexpr double kLittle = 0.01;  // lowered after the search
    EXPECT_LT(t.wv_lowered, kLittle);
    EXPECT_LT(t.Kv_lowered, kLittle);
  }
}

TEST(Tune, IsConfirmedByTheSimulationAtTheCrossovers) {
  const model::MachineSettings machine = hsm600u();
  const Tuning& t = tuned_Y();
  const model::MachineSettings tuned = with_gains(machine, kY, t.after.gains);
  const auto measured = [&](PositionLoop loop, Entry entry, AxisSignal y, AxisSignal e, double f) {
    const Measurement how{.entry = entry, .amplitude = default_amplitude(tuned, kY, entry)};
    return ratio(measure(tuned, kY, 0, loop, how, {f}).points.front().response, y, e);
  };
  // quantised encoders, and a frequency that is moved by up to a thousandth
  constexpr double kSizeTol = 0.01, kPhaseTol = 0.5 * deg;
  const Complex v =
      measured(PositionLoop::open, Entry::velocity_command, AxisSignal::measured_speed,
               AxisSignal::speed_error, t.after.velocity.crossover);
  EXPECT_NEAR(std::abs(v), 1.0, kSizeTol);
  EXPECT_NEAR(std::remainder(std::arg(-v), 2.0 * std::numbers::pi), t.after.velocity.phase,
              kPhaseTol);
  const Complex p = measured(PositionLoop::closed, Entry::setpoint, AxisSignal::reading,
                             AxisSignal::position_error, t.after.position.crossover);
  EXPECT_NEAR(std::abs(p), 1.0, kSizeTol);
  EXPECT_NEAR(std::remainder(std::arg(-p), 2.0 * std::numbers::pi), t.after.position.phase,
              kPhaseTol);
}

TEST(Tune, StopsAtTheOvershoot) {
  TuneSettings wanted;
  wanted.gain_margin = 1.5;
  wanted.phase_margin = 40.0 * deg;
  wanted.overshoot = 0.02;
  const Tuning t = tune(hsm600u(), kY, 0, wanted);
  expect_kept(t.after, wanted);
  EXPECT_EQ(t.position.kind, Limit::Kind::overshoot);
  EXPECT_NEAR(t.after.overshoot, wanted.overshoot, kRounding);
}

TEST(Tune, GoesNoHigherThanTheBandwidthNeeds) {
  TuneSettings wanted;
  wanted.bandwidth = 20.0;
  const Tuning t = tune(hsm600u(), kY, 0, wanted);
  expect_kept(t.after, wanted);
  EXPECT_EQ(t.position.kind, Limit::Kind::bandwidth);
  EXPECT_NEAR(t.after.closed.bandwidth / *wanted.bandwidth, 1.0, 2.0 * kRounding);
  EXPECT_LT(t.after.gains.Kv, t.Kv_limit);
}

TEST(Tune, TellsWhenALowerVelocityBandwidthAllowsMore) {
  model::MachineSettings machine = hsm600u();
  machine.drives[kY].T_i = 0.0;  // the velocity loop can be faster than the resonance
  const Tuning t = tune(machine, kY, 0, {});
  ASSERT_GT(t.calmer_wv, 0.0);
  TuneSettings wanted;
  wanted.wv_most = t.calmer_wv;
  const Tuning calmer = tune(machine, kY, 0, wanted);
  expect_kept(calmer.after, wanted);
  EXPECT_EQ(calmer.velocity.kind, Limit::Kind::most);
  EXPECT_GT(calmer.after.gains.Kv, 1.05 * t.after.gains.Kv);
}

TEST(Tune, KeepsMoreMarginAtALowerCommonKv) {
  const model::MachineSettings machine = hsm600u();
  const Tuning& own = tuned_Y();
  const Tuning common = with_common_Kv(machine, kY, 0, own, 0.8 * own.after.gains.Kv);
  expect_kept(common.after, {});
  EXPECT_GT(common.after.position.gain, own.after.position.gain);
  EXPECT_EQ(common.after.gains.wv, own.after.gains.wv);
}

TEST(Tune, RefusesWhatNoGainHas) {
  TuneSettings wanted;
  wanted.phase_margin = 85.0 * deg;
  try {
    tune(hsm600u(), kY, 0, wanted);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(),
                 "axis Y: error: no velocity_bandwidth above 20 rad/s gives both a phase margin of "
                 "85 deg and a gain margin of 8 dB; lower the margins or raise --reset-ratio");
  }
}

}  // namespace
}  // namespace servomill::sim::frequency::tuning_test

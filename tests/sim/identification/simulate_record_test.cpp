#include "sim/identification/simulate_record.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sim/identification/axis_experiment.h"

namespace servomill::sim::identification::simulate_record_test {
namespace {

AxisModel model_without_friction() {
  AxisModel model{small_axis(), small_loop()};
  model.drive.friction = {};
  model.drive.b_load = 0.0;
  return model;
}

Record still(std::size_t samples) {
  Record record;
  record.period = 1e-3;
  record.command.assign(samples, 0.0);
  record.feedback.assign(samples, 0.0);
  return record;
}

TEST(Simulate, AConstantForceOnAFreeMassGivesTheParabola) {
  Record record = still(200);
  record.force.assign(200, 19.0);
  AxisModel model = model_without_friction();
  model.loop.kind = LoopKind::open;
  model.position = 0.5;
  model.speed = -0.01;
  const Simulated out = simulate(record, {&model, 1}, 1).front();
  const double a = 19.0 / (model.drive.M + model.drive.J / (model.drive.r * model.drive.r));
  for (const std::size_t k : {std::size_t{0}, std::size_t{1}, std::size_t{199}}) {
    const double t = 1e-3 * static_cast<double>(k);
    EXPECT_NEAR(out.feedback[k], 0.5 - 0.01 * t + 0.5 * a * t * t, 1e-12);
  }
}

TEST(Simulate, AStepOfForceThatIsLateGivesTheParabolaOfThatTime) {
  Record record = still(50);
  record.force.assign(50, 19.0);
  record.force.front() = 0.0;
  AxisModel model = model_without_friction();
  model.loop.kind = LoopKind::open;
  model.loop.dead_time = 0.37e-3;
  const Simulated out = simulate(record, {&model, 1}, 1).front();
  const double a = 19.0 / (model.drive.M + model.drive.J / (model.drive.r * model.drive.r));
  const double t = 49e-3 - 1e-3 - model.loop.dead_time;
  // within the half of a period in which the force changes its mean acts instead
  constexpr double kPart = 0.5e-3;
  EXPECT_NEAR(out.feedback[49], 0.5 * a * t * t, 1.01 * a * kPart * kPart / 8.0);
}

TEST(Simulate, SlidingAtConstantSpeedNeedsViscousAndCoulombFriction) {
  Record record = still(3000);
  for (std::size_t k = 0; k < record.size(); ++k)
    record.command[k] = 0.05e-3 * static_cast<double>(k);
  const AxisModel model{small_axis(), small_loop()};
  const Simulated out = simulate(record, {&model, 1}, 1).front();
  EXPECT_NEAR(out.force.back(), 200.0 * 0.05 + 20.0, 1e-6);
  // lag of a P loop: v/Kv, and what the velocity loop needs for the force
  const double lag = 0.05 / 160.0 + out.force.back() / (8557.0 * 160.0);
  EXPECT_NEAR(record.command.back() - out.feedback.back(), lag, 1e-9);
}

// F = Fc + (b_load + b of the direction) v, for each form of friction.
TEST(Simulate, AConstantForceEndsAtTheSpeedOfItsDirection) {
  for (const auto kind : {plant::FrictionKind::set_valued, plant::FrictionKind::regularised,
                          plant::FrictionKind::lugre}) {
    for (const double sign : {1.0, -1.0}) {
      Record record = still(6000);
      record.force.assign(record.size(), sign * 60.0);
      AxisModel model{small_axis(), small_loop()};
      model.loop.kind = LoopKind::open;
      plant::FrictionParams& f = model.drive.friction;
      f.kind = kind;
      f.b_positive = 100.0;
      f.b_negative = 300.0;
      f.Fc_negative = f.Fs_negative = 25.0;
      f.v0 = 1e-4;
      f.sigma0 = 1e6;
      f.sigma1 = 1e3;
      const Simulated out = simulate(record, {&model, 1}, 1).front();
      const double speed = (out.feedback.back() - out.feedback[out.feedback.size() - 2]) / 1e-3;
      const double expected = sign > 0.0 ? 40.0 / 300.0 : -35.0 / 500.0;
      EXPECT_NEAR(speed, expected, 1e-6) << static_cast<int>(kind);
    }
  }
}

// M dv/dt = -Fc - b v from v on: stops after M/b ln(1 + b v / Fc).
TEST(Simulate, ASlideLeftAloneStopsWhenTheFormulaSays) {
  Record record = still(1200);
  record.force.assign(record.size(), 0.0);
  AxisModel model{small_axis(), small_loop()};
  model.loop.kind = LoopKind::open;
  model.drive.friction.b_positive = 100.0;
  model.speed = 0.1;
  const Simulated out = simulate(record, {&model, 1}, 1).front();
  const double M = model.drive.slide_mass(), b = 300.0, Fc = 20.0;
  const double stop = M / b * std::log(1.0 + b * 0.1 / Fc);
  const double way = M / b * 0.1 - Fc / b * stop;
  EXPECT_NEAR(out.feedback.back(), way, 1e-9);
  const auto before = static_cast<std::size_t>(stop / 1e-3);
  EXPECT_GT(out.feedback[before + 1] - out.feedback[before], 0.0);
  EXPECT_EQ(out.feedback[before + 3], out.feedback.back());
}

TEST(Simulate, AForceFromOutsideIsHeldByTheLoop) {
  Record record = still(2000);
  record.disturbance.assign(2000, 50.0);
  AxisModel model = model_without_friction();
  const Simulated out = simulate(record, {&model, 1}, 1).front();
  EXPECT_NEAR(out.force.back(), -50.0, 1e-6);
  EXPECT_NEAR(out.feedback.back(), 50.0 / (8557.0 * 160.0), 1e-9);
}

TEST(Simulate, ModelsGiveTheSameBitsAloneAndTogetherOnAnyThreads) {
  const Record motion = ramps(0.5);
  Record record = motion;
  record.feedback = motion.command;
  std::vector<AxisModel> models(11, AxisModel{small_axis(), small_loop()});
  for (std::size_t k = 0; k < models.size(); ++k) models[k].drive.M += static_cast<double>(k);
  const auto together = simulate(record, models, 2);
  for (const std::size_t k : {std::size_t{0}, std::size_t{7}, std::size_t{10}}) {
    const Simulated alone = simulate(record, {&models[k], 1}, 1).front();
    EXPECT_EQ(alone.feedback, together[k].feedback);
    EXPECT_EQ(alone.force, together[k].force);
  }
}

TEST(Simulate, EncodersAreReadInTheirSteps) {
  const Record motion = ramps(0.2);
  AxisModel model{small_axis(), small_loop()};
  model.step = 1e-6;
  const Record out = recorded(motion, model);
  for (const double y : out.feedback) EXPECT_NEAR(std::remainder(y, 1e-6), 0.0, 1e-15);
}

}  // namespace
}  // namespace servomill::sim::identification::simulate_record_test

#include "sim/preparation/tooth_step.h"

#include <gtest/gtest.h>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"

namespace servomill::sim::preparation::tooth_step_test {
namespace {

// Base period 10 us, velocity loop 0.6 ms, position loop 1.8 ms.
const model::LoopPeriods kPeriods{.base = 10 * us, .position = 180, .velocity = 60, .current = 20};

Tick step(double passing_frequency, int steps, model::ServoModel servo = model::ServoModel::cascade,
          double highest_mode = 0.0) {
  model::CuttingSpec cutting;
  cutting.steps_per_tooth = steps;
  cutting.place = {"cut.toml", 7, 1};
  return tooth_step(cutting, passing_frequency, highest_mode, kPeriods, servo);
}

std::string refusal(double passing_frequency, int steps,
                    model::ServoModel servo = model::ServoModel::cascade,
                    double highest_mode = 0.0) {
  try {
    step(passing_frequency, steps, servo, highest_mode);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ToothStep, is_the_longest_part_of_the_velocity_period_that_resolves_a_passage) {
  EXPECT_EQ(step(50.0, 20), 60) << "1 ms would do";
  EXPECT_EQ(step(4775.0 / 60.0 * 4.0, 20), 15) << "157 us: a quarter of 600 us";
  EXPECT_EQ(step(250.0, 20), 20) << "200 us, exactly a third";
  EXPECT_EQ(step(250.0, 4), 60);
}

TEST(ToothStep, is_refused_below_the_base_period) {
  EXPECT_EQ(step(5000.0, 20), 1) << "10 us are still a tick";
  EXPECT_EQ(
      refusal(5001.0, 20),
      "cut.toml:7:1: error: teeth pass every 200 us; 20 steps of force for each need a base period "
      "of at most 9.998 us; it is 10 us (lower the speed or steps_per_tooth)");
}

TEST(ToothStep, resolves_a_mode_that_vibrates) {
  constexpr auto kCascade = model::ServoModel::cascade;
  EXPECT_EQ(step(50.0, 20, kCascade, 500.0), 10) << "20 steps of 2 ms";
  EXPECT_EQ(step(4775.0 / 60.0 * 4.0, 20, kCascade, 100.0), 15) << "the teeth need more";
  EXPECT_EQ(step(50.0, 20, kCascade, 5000.0), 1) << "10 us are still a tick";
  EXPECT_EQ(refusal(50.0, 20, kCascade, 5001.0),
            "cut.toml:7:1: error: 20 steps in each period of the mode of 5001 Hz need a base "
            "period of at most 9.998 us; it is 10 us");
}

TEST(ToothStep, of_ideal_axes_is_their_position_period) {
  constexpr auto kIdeal = model::ServoModel::ideal;
  EXPECT_EQ(step(27.0, 20, kIdeal), 180);
  EXPECT_EQ(
      refusal(28.0, 20, kIdeal),
      "cut.toml:7:1: error: teeth pass every 3.571e+04 us; 20 steps of force for each need a "
      "position period of at most 1786 us; it is 1800 us (lower the speed or steps_per_tooth)");
}

}  // namespace
}  // namespace servomill::sim::preparation::tooth_step_test

/// Steps of the drives over a schedule: past instants of the error model alone, up to all others.
#include "sim/engine/drive_steps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace servomill::sim::engine::drive_steps_test {
namespace {

// Instants at which the error model is due every `model` ticks, the current loop every `current`.
std::vector<model::Instant> schedule_of(Tick current, Tick model) {
  return model::make_schedule({{model::kCurrentLoop, current, 0}, {model::kErrorModel, model, 0}});
}

TEST(DriveSteps, LeadsPastInstantsOfTheErrorModelAlone) {
  const DriveSteps steps = drive_steps(schedule_of(10, 6));  // 0 6 10 12 18 20 24 (30)
  const std::vector<plant::Stretch> wanted = {{10, {6}}, {10, {2, 8}}, {10, {4}}};
  EXPECT_EQ(steps.stretches, wanted);
  EXPECT_TRUE(steps.steps.empty());
  EXPECT_EQ(steps.most_stops, 2U);
  const std::vector<std::pair<Tick, int>> legs = {{10, 0}, {10, 1}, {10, 2}};
  ASSERT_EQ(steps.legs.size(), legs.size());
  for (std::size_t n = 0; n < legs.size(); ++n) {
    EXPECT_EQ(std::pair(steps.legs[n].step, steps.legs[n].stretch), legs[n]) << n;
  }
}

TEST(DriveSteps, StopsWhereAnythingElseIsDue) {
  for (const model::Due due : {model::kFeedbackSample, model::kPositionLoop, model::kVelocityLoop,
                               model::kCurrentLoop, model::kRecord}) {
    const DriveSteps steps =
        drive_steps(model::make_schedule({{model::kErrorModel, 10, 0}, {due, 5, 0}}));
    EXPECT_TRUE(steps.stretches.empty());
    EXPECT_EQ(steps.steps, (std::vector<Tick>{5, 5}));
  }
  // what nobody is due at may be looked at
  EXPECT_TRUE(drive_steps({{model::kCurrentLoop, 5}, {0, 5}}).stretches.empty());
}

TEST(DriveSteps, HasEightStopsOnAStretchAtMost) {
  const std::vector<plant::Stretch> one = {{9, {1, 2, 3, 4, 5, 6, 7, 8}}};
  EXPECT_EQ(drive_steps(schedule_of(9, 1)).stretches, one);
  const DriveSteps longer = drive_steps(schedule_of(10, 1));
  EXPECT_EQ(longer.stretches, one);
  EXPECT_EQ(longer.steps, std::vector<Tick>{1});  // the tenth
}

TEST(DriveSteps, EndsALegAtEachStopIfAsked) {  // as CVODE needs it
  const DriveSteps steps = drive_steps(schedule_of(10, 6), 0);
  EXPECT_TRUE(steps.stretches.empty());
  EXPECT_EQ(steps.steps, (std::vector<Tick>{6, 4, 2, 6, 2, 4, 6}));
}

TEST(DriveSteps, HasThirtyTwoStretchesAtMost) {
  for (const Tick current : {32, 33, 34, 37}) {
    // 1 tick later in each period of the current loop: stops at 1, 2, ... current - 1 after it
    const DriveSteps steps = drive_steps(schedule_of(current, current + 1));
    const Tick stretches = std::min<Tick>(current - 1, 32);
    EXPECT_EQ(steps.stretches.size(), static_cast<std::size_t>(stretches));
    const Tick others = current - 1 - stretches;  // in two steps each; two periods have no stop
    EXPECT_EQ(steps.steps.size(), static_cast<std::size_t>(2 + 2 * others)) << current;
    Tick total = 0;
    for (const DriveSteps::Leg& leg : steps.legs) total += leg.step;
    EXPECT_EQ(total, current * (current + 1));
  }
}

}  // namespace
}  // namespace servomill::sim::engine::drive_steps_test

#include "sim/programs/post_functions.h"

#include <gtest/gtest.h>

namespace servomill::sim::programs::post_functions_test {
namespace {

using controllers::ClRecord;

constexpr double kRetractZ = 0.4;  // m

controllers::PostOptions safe_options() {
  controllers::PostOptions options;
  options.safe.retract_Z = kRetractZ;
  return options;
}

ClRecord record(MoveKind kind, int number = 0, double value = 0.0) {
  ClRecord out;
  out.kind = kind;
  out.number = number;
  out.value = value;
  return out;
}

Move block(MoveKind kind, int number = 0, double value = 0.0, int direction = 0) {
  Move out;
  out.kind = kind;
  out.number = number;
  out.value = value;
  out.direction = direction;
  out.line = 4;
  return out;
}

PostState retracted() {
  PostState state;
  state.Q[2] = kRetractZ;
  return state;
}

TEST(PostFunctions, ToolsComeInTheirOrderAtTheHeightToRetractTo) {
  const auto options = safe_options();
  PostFunctions functions(options);
  functions.expect_tool(1);
  functions.expect(record(MoveKind::tool, 2));
  EXPECT_TRUE(functions.changes_tool());
  PostState now = retracted();
  EXPECT_EQ(functions.act(block(MoveKind::tool, 2), now, false),
            "tool 2 is loaded, which the cutter locations do not call");
  EXPECT_EQ(functions.act(block(MoveKind::tool, 1), now, false), "");
  EXPECT_EQ(functions.arrive(now), "tool 2 is not loaded");
  now.Q[2] -= 1e-6;
  EXPECT_EQ(functions.act(block(MoveKind::tool, 2), now, false),
            "the tool is changed below the retract height");
}

TEST(PostFunctions, ABlockThatStopsTheSpindleAndChangesTheToolIsRefused) {
  const auto options = safe_options();
  PostFunctions functions(options);
  functions.expect_tool(1);
  PostState now = retracted();
  EXPECT_EQ(functions.act(block(MoveKind::spindle, 0, 60.0, 1), now, false), "");
  EXPECT_EQ(functions.act(block(MoveKind::spindle), now, false), "");
  EXPECT_EQ(functions.act(block(MoveKind::tool, 1), now, false),
            "the tool is changed while the spindle or the coolant is on");
  EXPECT_EQ(functions.act(block(MoveKind::end), now, false),
            "the program ends with the spindle on");
}

TEST(PostFunctions, DwellsAreThoseOfTheLocationsAndInTheirPlace) {
  const auto options = safe_options();
  PostFunctions functions(options);
  const ClRecord dwell = record(MoveKind::dwell, 0, 0.5);
  functions.expect(dwell);
  functions.expect(dwell);
  PostState now;
  EXPECT_TRUE(functions.is_pending());
  EXPECT_EQ(functions.act(block(MoveKind::dwell, 0, 0.4), now, false),
            "a dwell, stop or message that the cutter locations do not have here");
  EXPECT_EQ(functions.act(block(MoveKind::dwell, 0, 0.5), now, false), "");
  EXPECT_EQ(functions.act(block(MoveKind::dwell, 0, 0.5), now, true),
            "the dwell is not at its location");
  EXPECT_FALSE(functions.is_pending());
}

TEST(PostFunctions, SpindleAndCoolantAreComparedWhereTheProgramArrives) {
  const auto options = safe_options();
  PostFunctions functions(options);
  ClRecord spindle = record(MoveKind::spindle, 0, 60.0);
  spindle.direction = -1;
  functions.expect(spindle);
  functions.expect(record(MoveKind::coolant, 2));
  PostState now;
  now.direction = 1;
  now.speed = 60.0;
  EXPECT_EQ(functions.arrive(now), "the spindle does not run as the cutter locations specify");
  now.direction = -1;
  EXPECT_EQ(functions.arrive(now), "the coolant is not as the cutter locations specify");
  now.coolant = 2;
  EXPECT_EQ(functions.arrive(now), "");
}

}  // namespace
}  // namespace servomill::sim::programs::post_functions_test

// Programs rewritten for identified errors that depend on the direction of travel.
#include "strategies/gcode.h"

#include <gtest/gtest.h>

#include "tests/strategies/identified_machines.h"

namespace servomill::strategies::gcode_test {
namespace {

using plant::operator""_err;

constexpr double kWidth = 10e-6, kDistance = 0.1 * mm;

std::vector<Move> there_and_back() {
  Move out;
  out.kind = MoveKind::feed;
  out.feed = 10.0 * mm;
  out.end_machine << 5.0 * mm, 0.0, 0.0, 0.0, 0.0, 0.0;
  out.end = out.end_machine;
  out.s_end = 5.0 * mm;
  Move back = out;
  back.end_machine[0] = back.end[0] = 0.0;
  back.s_begin = out.s_end;
  back.s_end = 10.0 * mm;
  return {out, back};
}

std::vector<Move> rewritten(Action action) {
  plant::ErrorModel errors;
  errors.component("EXX"_err) = plant::reversal({kWidth}, kDistance);
  IdentifiedMachine identified = identified_with(errors, "[w b X Y Z (C1) t]");
  identified.reference.setZero();
  const Entry entry = gcode_entry();
  return entry.make(default_parameters(entry), action, identified)->rewrite(there_and_back());
}

// Up, the axis goes 5 um too far; down, 5 um too little; in between as long as the change takes.
TEST(Gcode, CorrectsReversalForTheDirectionOfTravel) {
  for (const Action action : {Action::compensate, Action::impose}) {
    const double up = (action == Action::compensate ? -0.5 : 0.5) * kWidth;
    const std::vector<Move> moves = rewritten(action);
    ASSERT_EQ(moves.size(), 12U);  // five blocks of 1 mm each way, and two changes
    EXPECT_NEAR(moves[0].end_machine[0], kDistance + up, 1e-12);
    EXPECT_NEAR(moves[1].end_machine[0], 1.0 * mm + up, 1e-12);
    EXPECT_NEAR(moves[5].end_machine[0], 5.0 * mm + up, 1e-12);
    EXPECT_NEAR(moves[6].end_machine[0], 5.0 * mm - kDistance - up, 1e-12);
    EXPECT_NEAR(moves[7].end_machine[0], 4.0 * mm - up, 1e-12);
    EXPECT_NEAR(moves[11].end_machine[0], -up, 1e-12);
  }
}

// C turns alone, X waits; the next block stands on the path of the program (F500 is in degrees for
// it) and brings X to where the error at that angle wants it: 500 mm/min, not 8727.
TEST(Gcode, BringsAWaitingAxisToItsPlaceWithTheProgrammedFeed) {
  plant::ErrorModel errors;
  errors.component("EXC"_err) = plant::harmonic(10e-6, 360.0 * deg);
  IdentifiedMachine identified = identified_with(errors);
  identified.reference.setZero();
  Move turn;
  turn.kind = MoveKind::feed;
  turn.feed = 500.0 * deg_per_min;
  turn.end_machine[index_of(Axis::C)] = 90.0 * deg;
  turn.end = turn.end_machine;
  const Entry entry = gcode_entry();
  const std::vector<Move> out =
      entry.make(default_parameters(entry), Action::compensate, identified)->rewrite({turn, turn});
  ASSERT_EQ(out.size(), 2U);
  EXPECT_EQ(out[0].end_machine[0], 0.0);
  EXPECT_NEAR(out[0].feed, 500.0 * deg_per_min, 1e-12);
  EXPECT_GT(out[1].end_machine.head<3>().norm(), 1e-6);
  EXPECT_NEAR(out[1].feed, 500.0 * mm_per_min, 1e-12);
}

}  // namespace
}  // namespace servomill::strategies::gcode_test

// Programs rewritten for identified errors that depend on the direction of travel.
#include "strategies/gcode.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/geometry/reversal_memory.h"
#include "plant/vocabulary/spline_curve.h"
#include "tests/strategies/identified_machines.h"

namespace servomill::strategies::gcode_test {
namespace {

using plant::operator""_err;

constexpr double kWidth = 10e-6, kDistance = 0.1 * mm;
constexpr double kTolerance = 0.1e-6;  // m, chord tolerance of the blocks: the default

Move feed_to(const Eigen::Vector3d& end, double s_begin, double s_end) {
  Move out;
  out.kind = MoveKind::feed;
  out.feed = 10.0 * mm;
  out.end_machine.head<3>() = end;
  out.end = out.end_machine;
  out.s_begin = s_begin;
  out.s_end = s_end;
  return out;
}

std::vector<Move> there_and_back() {
  return {feed_to({5.0 * mm, 0.0, 0.0}, 0.0, 5.0 * mm), feed_to({0, 0, 0}, 5.0 * mm, 10.0 * mm)};
}

// The identified model starts at zero.
IdentifiedMachine machine_with(const plant::ErrorModel& errors) {
  IdentifiedMachine identified = identified_with(errors, "[w b X Y Z (C1) t]");
  identified.reference.setZero();
  return identified;
}

std::vector<Move> rewritten(const IdentifiedMachine& identified, const std::vector<Move>& moves,
                            Action action = Action::compensate, double max_block = 1.0 * mm) {
  const Entry entry = gcode_entry();
  Parameters parameters = default_parameters(entry);
  parameters.set("max_block_mm", max_block);
  return rewritten_moves(*entry.make(parameters, action, identified), moves);
}

// Machine that goes straight from block to block, with the hysteresis of its true positions.
class TrueMachine {
 public:
  explicit TrueMachine(const IdentifiedMachine& machine)
      : machine_(machine),
        memory_(machine.model.plays(), machine.reference),
        directions_(memory_.size()),
        at_(machine.reference) {}

  // TCP (m) at steps of the way to the end of a block.
  std::vector<Eigen::Vector3d> go(const Move& block) {
    constexpr int kSteps = 10;
    const Joints end = machine_.layout.joints(block.end_machine), begin = at_;
    std::vector<Eigen::Vector3d> out;
    for (int i = 1; i <= kSteps; ++i) {
      at_ = begin + (end - begin) * i / kSteps;
      memory_.travel(at_);
      memory_.directions(at_, directions_);
      out.push_back(at_.head<3>() + machine_.model.error(at_, machine_.p_ST, directions_).dp_W);
    }
    return out;
  }

 private:
  const IdentifiedMachine& machine_;
  plant::ReversalMemory memory_;
  std::vector<double> directions_;
  Joints at_;
};

// Up, the axis goes 5 um too far; down, 5 um too little; in between as long as the change takes.
TEST(Gcode, CorrectsReversalForTheDirectionOfTravel) {
  plant::ErrorModel errors;
  errors.component("EXX"_err) = plant::reversal({kWidth}, kDistance);
  const IdentifiedMachine identified = machine_with(errors);
  for (const Action action : {Action::compensate, Action::impose}) {
    const double up = (action == Action::compensate ? -0.5 : 0.5) * kWidth;
    const std::vector<Move> moves = rewritten(identified, there_and_back(), action);
    for (const Move& move : moves) {
      const bool goes_up = move.s_end <= 5.0 * mm;
      const double x = goes_up ? move.s_end : 10.0 * mm - move.s_end;
      const double travelled = goes_up ? move.s_end : move.s_end - 5.0 * mm;
      if (travelled < 1.1 * kDistance) continue;
      EXPECT_NEAR(move.end_machine[0], x + (goes_up ? up : -up), 1e-12) << move.s_end;
    }
    EXPECT_LT(moves.size(), 60U);
  }
}

// Block ends are exact, chords within the tolerance.
TEST(Gcode, CorrectsReversalWhileItDevelops) {
  for (const double width : {kWidth, -kWidth}) {
    plant::ErrorModel errors;
    errors.component("EXX"_err) = plant::reversal({width}, kDistance);
    const IdentifiedMachine identified = machine_with(errors);
    TrueMachine machine(identified);
    for (const Move& block : rewritten(identified, there_and_back())) {
      const double x = block.s_end <= 5.0 * mm ? block.s_end : 10.0 * mm - block.s_end;
      EXPECT_NEAR(machine.go(block).back()[0], x, 1e-9) << block.s_end;
    }
  }
}

// A full circle of 20 mm about (20, 0) mm, begun where the tool has come to it along X; `turns` as
// in Arc.
std::vector<Move> circle(int turns, double begin_angle) {
  constexpr double kRadius = 20.0 * mm;
  const Eigen::Vector3d centre(20.0 * mm, 0.0, 0.0);
  const Eigen::Vector3d begin =
      centre + kRadius * Eigen::Vector3d(std::cos(begin_angle), std::sin(begin_angle), 0.0);
  const double lead = begin.norm();
  Move arc = feed_to(begin, lead, lead + 2.0 * std::numbers::pi * kRadius);
  arc.kind = MoveKind::arc;
  arc.arc.normal_axis = 2;
  arc.arc.turns = turns;
  arc.arc.centre = arc.centre_machine = centre;
  return {feed_to(begin, 0.0, lead), arc};
}

// Greatest less smallest distance from the centre, after the motion to the circle.
double roundness(const IdentifiedMachine& identified, const std::vector<Move>& program,
                 const std::vector<Move>& blocks) {
  const Eigen::Vector3d centre = program.back().centre_machine;
  TrueMachine machine(identified);
  double least = 1.0, most = 0.0;
  for (const Move& block : blocks) {
    for (const Eigen::Vector3d& p : machine.go(block)) {
      if (block.s_end <= program.front().s_end) continue;
      const double r = (p - centre).norm();
      least = std::min(least, r);
      most = std::max(most, r);
    }
  }
  return most - least;
}

// Lost motion of w on both axes displaces the quarters of a circle along its diagonals, in and out:
// its roundness is w without correction, the chord tolerances with it. Blocks of a quarter and of
// more than the circle are divided where an axis reverses, as short ones are.
TEST(Gcode, DividesArcsWhereAnAxisReverses) {
  constexpr double kLost = -3.0 * um;
  for (const double distance : {0.5 * mm, 0.05 * mm, 0.01 * mm}) {
    plant::ErrorModel errors;
    errors.component("EXX"_err) = plant::reversal({kLost}, distance);
    errors.component("EYY"_err) = plant::reversal({kLost}, distance);
    const IdentifiedMachine identified = machine_with(errors);
    const IdentifiedMachine unaware = machine_with(plant::ErrorModel());
    for (const int turns : {1, -1}) {
      for (const double begin : {0.3, 0.0, 2.5}) {
        const std::vector<Move> program = circle(turns, begin);
        EXPECT_GT(roundness(identified, program, rewritten(unaware, program)), 2.0 * um);
        for (const double block : {1.0 * mm, 30.0 * mm, 500.0 * mm}) {
          const std::vector<Move> blocks =
              rewritten(identified, program, Action::compensate, block);
          EXPECT_LT(roundness(identified, program, blocks), 2.0 * kTolerance)
              << distance << " " << turns << " " << begin << " " << block;
        }
      }
    }
  }
}

// A quarter of that circle as a NURBS becomes blocks whose ends lie on it.
TEST(Gcode, ReplacesSplinesByBlocksOnTheirCurve) {
  constexpr double kRadius = 20.0 * mm;
  const Eigen::Vector3d begin(40.0 * mm, 0.0, 0.0), end(20.0 * mm, 20.0 * mm, 0.0);
  const std::vector<Eigen::Vector3d> points = {begin, {40.0 * mm, 20.0 * mm, 0.0}, end};
  const double lead = begin.norm(), length = 0.5 * std::numbers::pi * kRadius;
  Move move = feed_to(end, lead, lead + length);
  move.kind = MoveKind::spline;
  move.spline = std::make_shared<const Spline>(
      Spline{SplineCurve(3, points, {1.0, std::sqrt(0.5), 1.0}), points});
  const std::vector<Move> blocks =
      rewritten(machine_with(plant::ErrorModel()), {feed_to(begin, 0.0, lead), move},
                Action::compensate, 1.0 * mm);
  EXPECT_GT(blocks.size(), 60U);
  for (const Move& block : blocks) {
    EXPECT_EQ(block.kind, MoveKind::feed);
    EXPECT_EQ(block.spline, nullptr);
    if (block.s_end <= lead) continue;
    const double angle = (block.s_end - lead) / kRadius;
    const Eigen::Vector3d wanted(20.0 * mm + kRadius * std::cos(angle), kRadius * std::sin(angle),
                                 0.0);
    EXPECT_LT((block.end_machine.head<3>() - wanted).norm(), 1e-11) << block.s_end;
  }
}

// The tip waits off the axis of the table, which turns by 180 degrees under TCP control: X and Y
// follow the circle and reverse on the way.
TEST(Gcode, DividesTurnsUnderTipControlWhereAnAxisReverses) {
  plant::ErrorModel errors;
  errors.component("EXX"_err) = plant::reversal({-kWidth}, kDistance);
  errors.component("EYY"_err) = plant::reversal({-kWidth}, kDistance);
  IdentifiedMachine identified = identified_with(errors);
  identified.reference.setZero();
  const plant::MachineChain& chain = identified.model.chain();
  const auto tip = [&](const Joints& Q) { return plant::forward(chain, Q, identified.p_ST).p_WT; };
  const Eigen::Vector3d p = tip(Joints::Zero()) + Eigen::Vector3d(30.0 * mm, 5.0 * mm, 0.0);
  Move there = feed_to(p, 0.0, std::hypot(30.0, 5.0) * mm);
  there.tool_control = ToolControl::rotary_axes;
  Move turn = there;
  turn.s_begin = turn.s_end;
  turn.end_machine[index_of(Axis::C)] = turn.end[index_of(Axis::C)] = std::numbers::pi;
  plant::ReversalMemory memory(identified.model.plays(), identified.reference);
  std::vector<double> directions(memory.size());
  std::vector<double> x;  // m, at the ends of the blocks of the turn
  for (const Move& block : rewritten(identified, {there, turn})) {
    const Joints Q = identified.layout.joints(block.end_machine);
    memory.travel(Q);
    memory.directions(Q, directions);
    const Eigen::Vector3d at = tip(Q) + identified.model.error(Q, identified.p_ST, directions).dp_W;
    if (block.s_begin < turn.s_begin) continue;
    x.push_back(Q[0]);
    EXPECT_LT((at - p).norm(), 5e-9) << block.s_end;  // m; products of errors and of turned blocks
  }
  const auto [least, most] = std::minmax_element(x.begin(), x.end());
  const auto is_inside = [&](auto one) { return one != x.begin() && one + 1 != x.end(); };
  EXPECT_TRUE(is_inside(least) || is_inside(most));  // X has reversed
}

// Y does not move in the program; its correction follows the bow of X, up and down.
TEST(Gcode, DividesLinesWhereACorrectionReverses) {
  constexpr double kLost = -4.0 * um;
  plant::ErrorModel errors;
  errors.component("EYX"_err) = plant::harmonic(20.0 * um, 50.0 * mm, 0.0);
  errors.component("EYY"_err) = plant::reversal({kLost}, 0.01 * mm);
  const IdentifiedMachine identified = machine_with(errors);
  const std::vector<Move> program = {feed_to({100.0 * mm, 0.0, 0.0}, 0.0, 100.0 * mm)};
  for (const double block : {1.0 * mm, 50.0 * mm}) {
    const std::vector<Move> blocks = rewritten(identified, program, Action::compensate, block);
    TrueMachine machine(identified);
    for (const Move& move : blocks) {
      for (const Eigen::Vector3d& p : machine.go(move)) {
        EXPECT_NEAR(p[1], 0.0, 3.0 * kTolerance) << "at " << p[0] / mm << " of " << block / mm;
      }
    }
  }
}

// Taken up in less travel than its width, lost motion is a step of the axis at its reversal.
TEST(Gcode, TakesUpSteepLostMotionAtOnce) {
  plant::ErrorModel errors;
  errors.component("EXX"_err) = plant::reversal({-3.0 * um}, 0.5 * um);
  const IdentifiedMachine identified = machine_with(errors);
  const IdentifiedMachine unaware = machine_with(plant::ErrorModel());
  for (const int turns : {1, -1}) {
    const std::vector<Move> program = circle(turns, 0.3);
    const std::vector<Move> blocks = rewritten(identified, program);
    EXPECT_LT(blocks.size(), rewritten(unaware, program).size() + 100);
    TrueMachine machine(identified);
    for (const Move& block : blocks) {
      const Eigen::Vector3d end = machine.go(block).back();
      if (block.s_end <= program.front().s_end) continue;
      EXPECT_NEAR((end - program.back().centre_machine).norm(), 20.0 * mm, kTolerance);
    }
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
  const std::vector<Move> out = rewritten_moves(
      *entry.make(default_parameters(entry), Action::compensate, identified), {turn, turn});
  ASSERT_EQ(out.size(), 2U);
  EXPECT_EQ(out[0].end_machine[0], 0.0);
  EXPECT_NEAR(out[0].feed, 500.0 * deg_per_min, 1e-12);
  EXPECT_GT(out[1].end_machine.head<3>().norm(), 1e-6);
  EXPECT_NEAR(out[1].feed, 500.0 * mm_per_min, 1e-12);
}

// The spindle turns with the whole of a move: only its end is corrected.
TEST(Gcode, DoesNotDivideATap) {
  plant::ErrorModel errors;
  errors.component("EXX"_err) = plant::harmonic(20.0 * um, 20.0 * mm, 0.0);
  std::vector<Move> moves = there_and_back();
  EXPECT_GT(rewritten(machine_with(errors), moves).size(), 2U);
  moves[0].synchronised = Synchronised::tap_in;
  moves[1].synchronised = Synchronised::tap_out;
  for (Move& move : moves) move.value = 1.5 * mm;
  const std::vector<Move> tap = rewritten(machine_with(errors), moves);
  ASSERT_EQ(tap.size(), 2U);
  EXPECT_NEAR(tap[0].end_machine[0], 5.0 * mm - 20.0 * um, 0.1 * um);  // a quarter of the wave
  EXPECT_NEAR(tap[1].end_machine[0], 0.0, 1e-12);
  EXPECT_EQ(tap[0].synchronised, Synchronised::tap_in);
  EXPECT_EQ(tap[1].value, 1.5 * mm);
}

}  // namespace
}  // namespace servomill::strategies::gcode_test

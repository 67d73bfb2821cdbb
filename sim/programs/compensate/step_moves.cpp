#include "sim/programs/compensate/step_moves.h"

#include <cmath>

namespace servomill::sim::programs {

void StepMoves::write(const controllers::ExecutedBlock& block) {
  for (const Move& move : block.moves) {
    if (is_motion(move.kind)) {
      add(corrector_.next(move, block));
    } else {
      put_(move);
    }
  }
}

// Feed (m/s, or rad/s where the axes only turn) with which a block takes its share of the time.
double StepMoves::timed_feed(const Step& step, const FittedBlock& block, const AxisWords& begin) {
  const AxisWords turn = step.programmed.end - step.programmed.begin;
  const double length = step.programmed.length();
  const double whole = length > 0.0 ? length : turn.tail<3>().norm();
  const double share = block.t_end - block.t_begin;
  // a reading of the moves counts the way along the original path where there is one
  if (length > 0.0 || !(whole > 0.0) || !(share > 0.0)) return step.move->feed;
  const AxisWords way = block.end - begin;
  const double turned = way.tail<3>().norm();
  return (turned > 0.0 ? turned : way.head<3>().norm()) * step.move->feed / (share * whole);
}

void StepMoves::add(const Step& step) {
  const WorkFrame& frame = step.programmed.frame;
  AxisWords at = step.begin;
  for (const FittedBlock& block : step.blocks) {
    Move out = *step.move;
    if (out.kind == MoveKind::arc && !block.arc) out.kind = MoveKind::feed;
    out.end = block.end;
    out.end_machine = frame.machine(block.end);
    out.s_begin = step.programmed.s(block.t_begin);
    out.s_end = step.programmed.s(block.t_end);
    if (block.arc) {
      AxisWords centre = AxisWords::Zero();
      centre.head<3>() = block.arc->centre;
      out.arc = *block.arc;
      out.centre_machine = frame.machine(centre).head<3>();
    }
    if (out.kind != MoveKind::rapid && step.programmed.turns_axes()) {
      out.feed = timed_feed(step, block, at);
      if (out.feed_mode == FeedMode::units_per_minute) out.feed_mode = FeedMode::inverse_time;
    }
    put_(out);
    at = block.end;
  }
  corrector_.arrive(step, frame.machine(at));
}

}  // namespace servomill::sim::programs

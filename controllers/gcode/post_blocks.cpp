#include "controllers/gcode/post_blocks.h"

#include <cmath>

#include "controllers/gcode/printer.h"

namespace servomill::controllers {

Move& PostBlocks::add(MoveKind kind, int line) {
  Move& move = moves_.emplace_back();
  move.kind = kind;
  move.line = line;
  move.work_offset = options_.work_system;
  move.tool_offset = tool_;
  move.path_tolerance = rounding_;
  move.s_begin = move.s_end = s_;
  return move;
}

void PostBlocks::load(int tool, const ToolEntry* entry, int line) {
  tool_ = tool;
  tool_offset_ = entry != nullptr ? entry->offset : AxisWords::Zero();
  p_ST_ = -tool_offset_.head<3>();
  add(MoveKind::tool, line).number = tool;
}

void PostBlocks::program_line(const std::string& text) {
  if (text.empty()) return;
  Move& move = add(MoveKind::message, last_line_);
  move.number = kProgramLine;
  move.text = text;
}

void PostBlocks::function(const ClRecord& record) {
  if (record.kind == MoveKind::spindle) spindle_ = record.direction;
  if (record.kind == MoveKind::coolant) coolant_ = record.number;
  Move& move = add(record.kind, record.line);
  move.value = record.value;
  move.number = record.number;
  move.direction = record.direction;
  move.text = record.text;
}

void PostBlocks::stop_functions(double spindle_speed) {
  if (coolant_ != 0) add(MoveKind::coolant, last_line_).number = 0;
  if (spindle_ != 0) add(MoveKind::spindle, last_line_).value = spindle_speed;
  coolant_ = spindle_ = 0;
}

void PostBlocks::motion(MoveKind kind, int line, const ToolPose& P, const Joints& Q,
                        double path_length, double time) {
  last_line_ = line;
  Move& move = add(kind, line);
  AxisWords words = move.end_machine = inverse_.chain().layout.words(Q);
  if (options_.mode == PostMode::tip) {
    words.head<3>() = P.p_WT;
  } else {
    words -= tool_offset_;
  }
  words.head<3>() -= options_.work_offset;
  move.end = words;
  const bool moves_tip = path_length > 0.0;
  if (kind == MoveKind::feed) {
    const bool in_time = options_.mode != PostMode::tip || !moves_tip;
    move.feed_mode = in_time ? FeedMode::inverse_time : FeedMode::units_per_minute;
    const double rotation = (Q - Q_).tail<kJoints - kLinearJoints>().norm();
    note_speed(line, P, Q, time);
    // a block of no time at all: nothing moves
    move.feed = time > 0.0 ? (moves_tip ? path_length : rotation) / time : options_.rotary_rate;
  }
  s_ += path_length;
  move.s_end = s_;
  Q_ = Q;
}

// The NC slows down where a post-processed time is too short.
void PostBlocks::note_speed(int line, const ToolPose& P, const Joints& Q, double time) {
  if (!(time > 0.0)) return;
  // under tip control linear joints go elsewhere than to Q in between
  const int first = options_.mode == PostMode::tip ? kLinearJoints : 0;
  std::vector<FeedReduction> slowed;
  for (int j = first; j < kJoints; ++j) {
    if (!inverse_.chain().layout.has(j)) continue;
    const FeedReduction here{line, j, std::abs(Q[j] - Q_[j]) / time, options_.v_max[j],
                             inverse_.distance_from_singular(P.k_W)};
    if (here.needed > here.allowed) slowed.push_back(here);
  }
  if (!slowed.empty()) report_.note_slowed(slowed);
}

}  // namespace servomill::controllers

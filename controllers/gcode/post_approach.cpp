#include "controllers/gcode/post_approach.h"

#include <cmath>
#include <numbers>

#include "controllers/gcode/free_axis.h"
#include "controllers/gcode/number_text.h"

namespace servomill::controllers {

PostApproach::PostApproach(const plant::InverseKinematics& inverse, const PostOptions& options,
                           PostBlocks& blocks, PostReport& report)
    : inverse_(inverse),
      options_(options),
      blocks_(blocks),
      report_(report),
      safe_(inverse, options.safe, options.work_offset, options.work_system) {}

void PostApproach::retract() {
  blocks_.program_line(safe_.retract_line());
  blocks_.set_Q(safe_.retracted(blocks_.Q()));
  is_retracted_ = true;
}

// Along the tool axis away from the workpiece, then up.
void PostApproach::depart(int line, const ToolPose& here) {
  if (is_retracted_) return;
  const auto clear = safe_.joints_clear_of(here, blocks_.Q(), blocks_.p_ST());
  if (!clear.fault.empty()) return report_.fault(line, "on retract, " + clear.fault);
  blocks_.motion(MoveKind::rapid, line, safe_.clear_of(here), clear.Q, 0.0, 0.0);
  retract();
}

// Stops what the data stop first, then the rest.
void PostApproach::leave(const ToolPose& here) {
  depart(blocks_.last_line(), here);
  for (const ClRecord& record : held_) {
    const bool starts = (record.kind == MoveKind::spindle && record.direction != 0) ||
                        (record.kind == MoveKind::coolant && record.number != 0);
    if (!starts) emit(record);
  }
  held_.clear();
  blocks_.stop_functions(spindle_ ? spindle_->value : 0.0);
}

void PostApproach::leave_before(std::span<const ClRecord> records, const ToolPose& here) {
  const MoveKind kind = records.front().kind;
  if (!is_safe() || is_retracted_ || kind == MoveKind::dwell || kind == MoveKind::message) return;
  for (const ClRecord& record : records) {
    if (is_motion(record.kind)) return;
    if (record.kind == MoveKind::tool) break;
  }
  depart(blocks_.last_line(), here);
}

void PostApproach::approach(const ClRecord& record, const ToolPose& here, const ToolPose& P,
                            const Joints& Q) {
  depart(record.line, here);
  const auto clear = safe_.joints_clear_of(P, Q, blocks_.p_ST());
  if (!clear.fault.empty()) return report_.fault(record.line, "on approach, " + clear.fault);
  blocks_.program_line(safe_.rotary_line(Q));
  switch_on();
  blocks_.program_line(safe_.plane_line(clear.Q));
  is_retracted_ = false;
  blocks_.motion(MoveKind::rapid, record.line, safe_.clear_of(P), clear.Q, 0.0, 0.0);
  const double feed = record.feed > 0.0 ? record.feed : options_.feed;
  const bool feeds = record.kind != MoveKind::rapid && feed > 0.0;
  const double c = safe_.clearance();
  blocks_.motion(feeds ? MoveKind::feed : MoveKind::rapid, record.line, P, Q, feeds ? c : 0.0,
                 feeds ? c / feed : 0.0);
}

// Spindle and coolant as the locations ask for them, in the order of their records.
void PostApproach::switch_on() {
  for (const ClRecord& record : held_) emit(record);
  held_.clear();
  if (spindle_ && spindle_->direction != 0 && blocks_.spindle() == 0) emit(*spindle_);
  if (coolant_ && coolant_->number != 0 && blocks_.coolant() == 0) emit(*coolant_);
}

void PostApproach::switch_on_again() {
  if (blocks_.spindle() != 0) emit(*spindle_);
  if (blocks_.coolant() != 0) emit(*coolant_);
}

void PostApproach::finish(const ToolPose& here) {
  leave(here);
  Joints home = options_.start;
  for (int j = kLinearJoints; j < kJoints; ++j) {
    const bool is_endless = !std::isfinite(inverse_.settings().lower[j]) ||
                            !std::isfinite(inverse_.settings().upper[j]);
    if (!is_endless) continue;
    constexpr double kTurn = 2.0 * std::numbers::pi;  // rad
    home[j] += kTurn * std::round((blocks_.Q()[j] - home[j]) / kTurn);
  }
  if (rotation_between(blocks_.Q(), home) > 0.0) blocks_.program_line(safe_.rotary_line(home));
}

void PostApproach::function(const ClRecord& record) {
  if (record.kind == MoveKind::spindle) spindle_ = record;
  if (record.kind == MoveKind::coolant) coolant_ = record;
  if (is_safe() && is_retracted_) {
    held_.push_back(record);
  } else {
    emit(record);
  }
}

void PostApproach::emit(const ClRecord& record) {
  // no length, and no tip control above all, before X and Y are there
  if (record.kind == MoveKind::dwell && is_safe() && is_retracted_) {
    blocks_.program_line(dwell_block(record.value));
  } else {
    blocks_.function(record);
  }
}

}  // namespace servomill::controllers

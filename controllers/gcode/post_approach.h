/// Ways of a post-processed program to the workpiece and back: approach and retract along the tool
/// axis, spindle and coolant in the order that they allow.
///
/// Records that the data give while the tool is retracted wait for the next approach, which writes
/// them between the rotary and the linear axes.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "controllers/gcode/post_blocks.h"
#include "controllers/gcode/safe_approach.h"

namespace servomill::controllers {

class PostApproach {
 public:
  PostApproach(const plant::InverseKinematics& inverse, const PostOptions& options,
               PostBlocks& blocks, PostReport& report);

  bool is_safe() const { return options_.approach == Approach::safe; }
  bool is_retracted() const { return is_retracted_; }

  /// To the retract height. With a direct approach nothing of this class is used but function()
  /// and switch_on_again().
  void retract();

  /// Approach to P with the joints Q, after a departure from `here` unless the tool is retracted.
  void approach(const ClRecord& record, const ToolPose& here, const ToolPose& P, const Joints& Q);

  /// Departure from the last location, and stop of coolant and spindle.
  void leave(const ToolPose& here);

  /// Departure before functions that no location follows until a tool change or the end; a dwell
  /// belongs to the location.
  /// @param records  that which is about to be written, and all after it
  void leave_before(std::span<const ClRecord> records, const ToolPose& here);

  /// A record that is neither motion nor tool change.
  void function(const ClRecord& record);

  /// Spindle and coolant as before a tool change that stopped them.
  void switch_on_again();

  /// After the last record: leaves the workpiece, and turns rotary axes back to the start.
  void finish(const ToolPose& here);

 private:
  void depart(int line, const ToolPose& here);
  void switch_on();
  void emit(const ClRecord& record);

  const plant::InverseKinematics& inverse_;
  const PostOptions& options_;
  PostBlocks& blocks_;
  PostReport& report_;
  SafeApproach safe_;
  bool is_retracted_ = false;
  std::vector<ClRecord> held_;                 // while retracted, for switch_on()
  std::optional<ClRecord> spindle_, coolant_;  // as last asked for
};

}  // namespace servomill::controllers

/// Blocks of a post-processed program as they are written one after the other: the words of each
/// motion, its feed, and the state of the machine after it.
#pragma once

#include <string>
#include <vector>

#include "controllers/gcode/post_processor.h"
#include "controllers/gcode/post_report.h"

namespace servomill::controllers {

class PostBlocks {
 public:
  /// @param rounding  share of the tolerance of the tip that is left to the NC (G64 P; m)
  /// @param report    receives the blocks that exceed speed limits
  PostBlocks(const plant::InverseKinematics& inverse, const PostOptions& options, double rounding,
             PostReport& report)
      : inverse_(inverse),
        options_(options),
        report_(report),
        rounding_(rounding),
        Q_(options.start) {}

  /// Joints after the last block (5; m, rad).
  const Joints& Q() const { return Q_; }
  /// Assumes the joints elsewhere: after a retract that is no block, or an error.
  void set_Q(const Joints& Q) { Q_ = Q; }

  /// From the spindle nose to the tip of the tool in the spindle (3; m).
  const Eigen::Vector3d& p_ST() const { return p_ST_; }

  /// Line of the last location.
  int last_line() const { return last_line_; }

  /// Spindle (direction) and coolant (number) as the blocks have switched them; 0 is off.
  int spindle() const { return spindle_; }
  int coolant() const { return coolant_; }

  /// A tool change.
  /// @param entry  nullptr: of length 0
  void load(int tool, const ToolEntry* entry, int line);

  /// A line of program text that no move stands for; nothing if it is empty.
  void program_line(const std::string& text);

  /// A record of the cutter locations that is no motion, as a block of its own.
  void function(const ClRecord& record);

  /// Switches coolant and spindle off where they are on.
  /// @param spindle_speed  as in the block that switched the spindle on
  void stop_functions(double spindle_speed);

  /// One block to the joints Q, on which the tip covers its path (m) in that time (s).
  void motion(MoveKind kind, int line, const ToolPose& P, const Joints& Q, double path_length,
              double time);

  std::vector<Move> take() { return std::move(moves_); }

 private:
  Move& add(MoveKind kind, int line);
  void note_speed(int line, const ToolPose& P, const Joints& Q, double time);

  const plant::InverseKinematics& inverse_;
  const PostOptions& options_;
  PostReport& report_;
  std::vector<Move> moves_;
  double rounding_;  // m
  Joints Q_;
  double s_ = 0.0;  // m
  int last_line_ = 0;
  int tool_ = 0, spindle_ = 0, coolant_ = 0;
  AxisWords tool_offset_ = AxisWords::Zero();
  Eigen::Vector3d p_ST_ = Eigen::Vector3d::Zero();
};

}  // namespace servomill::controllers

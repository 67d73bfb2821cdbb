/// Cycle time of a program on a machine: the time of its motion, planned as in a simulation.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/path/trajectory.h"
#include "plant/vocabulary/move_list.h"
#include "sim/model/machine.h"
#include "sim/programs/known_positions.h"

namespace servomill::sim::programs {

/// Adds up motion and dwells. Moves over a distance that is not known (from where the machine
/// happens to be at the start, behind a tool change or between places of unknown offset) are left
/// out, and counted.
class ProgramDuration {
 public:
  explicit ProgramDuration(const model::MachineSettings& machine);

  void add(const Move& move, const MoveKnowledge& known);  ///< a motion
  void add(const Move& move);                              ///< anything else
  /// Moves that are not known: those of a cycle whose path is the control's own.
  void add_unknown_moves(std::string_view whose, int line);
  /// Plans the moves that are left.
  void finish();

  double duration() const { return duration_; }                   ///< s
  const std::vector<int>& left_out() const { return left_out_; }  ///< lines
  /// Lines of moves that are not known, by cycle. With any, the time is longer than
  /// `duration`.
  const std::map<std::string, std::vector<int>, std::less<>>& unknown_moves() const {
    return unknown_moves_;
  }
  const std::string& why_unknown() const { return why_unknown_; }  ///< empty: it is known
  int unknown_dwells() const { return unknown_dwells_; }
  int tool_changes() const { return tool_changes_; }
  int stops() const { return stops_; }  ///< M0, M1, M60

 private:
  bool refuses(const Move& move);
  void plan();

  const model::MachineSettings& machine_;
  controllers::JointLimits limits_;
  controllers::PathOptions options_;
  MoveList moves_;  // not planned yet
  Joints start_ = Joints::Zero();
  Joints at_ = Joints::Zero();
  double duration_ = 0.0;
  std::vector<int> left_out_;
  std::map<std::string, std::vector<int>, std::less<>> unknown_moves_;
  std::string why_unknown_;
  int tool_changes_ = 0, stops_ = 0, unknown_dwells_ = 0;
  MoveKind last_ = MoveKind::dwell;
};

}  // namespace servomill::sim::programs

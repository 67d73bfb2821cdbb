/// Cycle time of a program on a machine: the time of its motion, planned as in a simulation.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/gcode/tool_table.h"
#include "controllers/path/feed_reduction.h"
#include "controllers/path/trajectory.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/move_list.h"
#include "sim/model/forward.h"

namespace servomill::controllers {
class ToolCentrePoint;
}  // namespace servomill::controllers

namespace servomill::sim::programs {

/// Moves that were planned together, from rest to rest.
struct PlannedPart {
  const MoveList& moves;
  std::span<const std::uint16_t> files;  // of each move, as it was added
  const Joints& start;                   // m, rad
  const controllers::Trajectory& trajectory;
  /// Places where a joint cannot follow the programmed feed, under TCP control and in inverse time.
  std::span<const controllers::FeedReduction> slowed;
  std::vector<Fault> travel;  // moves that leave the travel
};

/// How a program is planned, beyond its machine.
struct DurationSettings {
  double feed_override = 1.0;
  Joints start = Joints::Zero();  // m, rad
  /// Under TCP control the path of the joints follows from kinematics and tools. Without them such
  /// moves make the duration unknown.
  std::shared_ptr<const controllers::ToolCentrePoint> tool_centre_point = {};
  const controllers::ToolTable* tools = nullptr;  // p_ST by number of tool offset
  std::string file = {};                          // of the program, for faults
  std::function<void(const PlannedPart&)> on_part = {};
};

/// Motion of the linear joints of these moves under TCP control; empty without such moves.
/// @throws InputError with every move that the machine cannot do
controllers::TipMotions tip_motions_of(const MoveList& moves, const Joints& start,
                                       const DurationSettings& settings,
                                       const controllers::JointLimits& limits,
                                       const controllers::PathOptions& options);

/// Adds up motion and dwells. Moves over a distance that is not known (from where the machine
/// happens to be at the start, behind a tool change or between places of unknown offset) are left
/// out, and counted.
class ProgramDuration {
 public:
  explicit ProgramDuration(const model::MachineSettings& machine, DurationSettings settings = {});

  /// A motion.
  /// @param is_known  if the distance is
  /// @param file      any number, for PlannedPart
  void add(const Move& move, bool is_known, std::uint16_t file = 0);
  /// Anything else.
  void add_other(const Move& move, std::uint16_t file = 0);
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
  const controllers::JointLimits& limits() const { return limits_; }
  const controllers::PathOptions& options() const { return options_; }

 private:
  bool refuses(const Move& move);
  void plan();
  Joints joints_at_end(const Move& move) const;

  const model::MachineSettings& machine_;
  DurationSettings settings_;
  controllers::JointLimits limits_;
  controllers::PathOptions options_;
  MoveList moves_;                    // not planned yet
  std::vector<std::uint16_t> files_;  // of each
  Joints start_;
  double duration_ = 0.0;
  std::vector<int> left_out_;
  std::map<std::string, std::vector<int>, std::less<>> unknown_moves_;
  std::string why_unknown_;
  int unknown_dwells_ = 0;
  MoveKind last_ = MoveKind::dwell;
};

}  // namespace servomill::sim::programs

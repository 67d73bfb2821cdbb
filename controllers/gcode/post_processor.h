/// Cutter locations to canonical moves of one machine, ready to be printed as G-code.
#pragma once

#include <string>
#include <vector>

#include "controllers/gcode/cl_data.h"
#include "controllers/gcode/tool_table.h"
#include "plant/kinematics/straight_tool_path.h"
#include "plant/vocabulary/move.h"

namespace servomill::controllers {

/// Who moves the tip straight from location to location.
enum class PostMode : std::uint8_t {
  joints,     // the program: points are inserted where the joints alone would leave the tolerance
  locations,  // nobody: one block a location (what paper [L] calls classical post-processing)
  tip,        // the NC, under G43.4: words are the tip; points are inserted for the tool axis alone
};

struct PostOptions {
  PostMode mode = PostMode::joints;
  plant::ToolTolerance tolerance;
  Eigen::Vector3d part_zero = Eigen::Vector3d::Zero();  // m in W: what the work offset holds
  int work_system = 1;                                  // 1 is G54
  ToolTable tools;                                      // empty: lengths are 0
  int tool = 0;                                         // of data that load none; 0: no tool, H0
  double feed = 0.0;              // m/s, where the data give none; 0: they must
  double turn_rate = 1.0;         // rad/s of the tool axis where the tip stands still
  Joints start = Joints::Zero();  // m, rad; chooses among the solutions of the first location
};

struct Posted {
  std::vector<Move> moves;  // `line` is that of the cutter location
  std::vector<Warning> warnings;
  std::size_t inserted = 0;  // points between locations
};

/// Posts every location to the joints nearest to those before, so that endless axes go on turning.
///
/// Rapids, and the first location whatever it is, become rapids of the joints; points are inserted
/// in feed moves only. The feed is that of the tip in the workpiece: without tip control each block
/// says how long it takes (G93), for an NC would take F as the speed of X, Y and Z in the machine.
/// Corners may be rounded by the tolerance of the tip (G64 P).
///
/// @param file     name for messages
/// @param inverse  with the travel of the machine
/// @throws InputError with every location that the machine cannot reach, or cannot reach from the
/// one before without a jump of its axes; every feed and tool that is not known
Posted post(const ClData& data, const std::string& file, const plant::InverseKinematics& inverse,
            const PostOptions& options);

/// The part of a message that says why a pose has no joints.
std::string reason(const plant::JointSolution& solution, const plant::InverseKinematics& inverse);

}  // namespace servomill::controllers

/// Cutter locations to canonical moves of one machine, ready to be printed as G-code.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "controllers/gcode/cl_data.h"
#include "controllers/gcode/safe_approach.h"
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

/// Way to the first location, to the first one after a tool change, and across rapids on which the
/// tool axis changes.
enum class Approach : std::uint8_t {
  safe,   // controllers/gcode/safe_approach.h
  direct  // one rapid of all axes, from wherever the machine is; no retract
};

struct PostOptions {
  Approach approach = Approach::safe;
  SafeApproachParams safe;
  PostMode mode = PostMode::joints;
  plant::ToolTolerance tolerance;
  Eigen::Vector3d work_offset = Eigen::Vector3d::Zero();  // m in W: what the work offset holds
  int work_system = 1;                                    // 1 is G54
  ToolTable tools;                                        // empty: lengths are 0
  int tool = 0;                   // in front of the first LOADTL; 0: no tool, H0
  double feed = 0.0;              // m/s, where the data give none; 0: they must
  double rotary_rate = 1.0;       // rad/s of the tool axis where the tip stands still
  Joints start = Joints::Zero();  // m, rad; chooses among the solutions of the first location
  // m/s, rad/s: limits for the warning of post-processed times
  Joints v_max = Joints::Constant(std::numeric_limits<double>::infinity());
};

/// Share of the tolerance of the tip for the chords between inserted points; the rest is the NC's
/// to round corners with (G64 P).
inline constexpr double kChordTolerance = 0.5;

struct PostProcessed {
  std::vector<Move> moves;  // `line` is that of the cutter location
  std::vector<Warning> warnings;
  std::size_t inserted = 0;  // points between locations
};

/// Posts every location to the joints nearest to those before, so that endless axes go on turning.
///
/// Rapids, and with Approach::direct the first location of each tool whatever it is, become rapids
/// of the joints; points are inserted in feed moves only. With Approach::safe the last stretch to a
/// location that is no rapid is moved at its feed, spindle and coolant are switched on between the
/// rotary and the linear axes, off at the retract height, and rotary axes come back to the start at
/// the end. The feed is that of the tip in the workpiece: without tip control each block says how
/// long it takes (G93), for an NC would take F as the speed of X, Y and Z in the machine. The
/// tolerance of the tip is shared by the chords of `PostMode::joints` and the rounding of corners
/// (G64 P); other modes leave all of it to the latter.
///
/// At a singular tool axis one axis is free. A rapid turns it to where it will be when the
/// tool axis leaves that direction, if such a location follows; a feed to that direction leaves it,
/// and it turns with the tip in place before the tool axis goes on, of which a warning tells.
///
/// @param file        name for messages
/// @param inverse     with the travel of the machine
/// @param of_refused  where a fault ends it: receives the warnings
/// @throws InputError with every location that the machine cannot reach, or cannot reach from the
/// one before without a jump of its axes; every feed and tool that is not known
PostProcessed post(const ClData& data, const std::string& file,
                   const plant::InverseKinematics& inverse, const PostOptions& options,
                   std::vector<Warning>* of_refused = nullptr);

/// The part of a message that says why a pose has no joints.
std::string reason(const plant::JointSolution& solution, const plant::InverseKinematics& inverse);

}  // namespace servomill::controllers

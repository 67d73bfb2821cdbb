/// Verification of a post-processed program against its cutter locations.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "controllers/gcode/post_processor.h"
#include "sim/model/forward.h"

namespace servomill::sim::programs {

/// Result of a verification without a fault.
struct PostVerification {
  std::size_t locations = 0, blocks = 0;
  double tip = 0.0;   // m: largest distance of the tip from the straight path between locations
  double axis = 0.0;  // rad: of the tool axis from its great circle
  bool only_locations = false;  // classical: nothing between them was compared
};

/// Reads the program as LinuxCNC does (controllers/gcode/interpreter.h), from a machine that is
/// somewhere else, and compares it with the cutter locations through the forward kinematics:
///   - every location is reached in its order, tip and tool axis to the digits of the program
///   - between locations tip and tool axis stay within the tolerance, corners are rounded by no
///     more (G64 P), and the blocks take the time that the feed of the tip asks for; a rapid is
///     one where the locations say so
///   - tool, spindle and coolant are the wanted ones at every location; dwells, stops and messages
///     come between the same locations
///   - with Approach::safe rotary axes move at the retract height only; below it the tool moves
///     along the machine's Z down to the clearance, and along its own axis from there; the program
///     ends at the retract height with spindle and coolant off and the rotary axes at their start
///
/// @param cl_file  for messages
/// @throws InputError with the line of the program and of the location
PostVerification verify_post(const std::string& program, const controllers::ClData& data,
                             const model::MachineSettings& machine,
                             const controllers::PostOptions& options, const std::string& cl_file);

/// "verified: 20 locations, 31 blocks, tip within 0.42 um and tool axis within 3.1 urad of the
/// path"
std::string to_string(const PostVerification& verification);

}  // namespace servomill::sim::programs

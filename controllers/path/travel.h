/// Does a program stay within the travel of the machine?
#pragma once

#include <span>
#include <string>
#include <vector>

#include "controllers/path/tcp_motion.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/move_list.h"

namespace servomill::controllers {

/// "X moves to 301.0000 mm, outside the travel; must be <= 300.0000"; empty within it.
/// @param low, high     range of a joint (m, rad)
/// @param lower, upper  of its travel
std::string outside_travel(const JointLayout& layout, int joint, double low, double high,
                           double lower, double upper);

/// Every move that leaves the travel, one fault a joint, arcs with their extreme points; of more
/// than a thousand their number and the last.
/// @param start         joints before the first move (5; m, rad)
/// @param lower, upper  (5; m, rad), infinite for an endless axis; the bounds belong to the travel
/// @param file          of the program, for the place of the faults
/// @param tip           of the same moves
std::vector<Fault> travel_faults(const MoveRange& moves, const JointLayout& layout,
                                 const Joints& start, const Joints& lower, const Joints& upper,
                                 const std::string& file, const TipMotions& tip = {});

}  // namespace servomill::controllers

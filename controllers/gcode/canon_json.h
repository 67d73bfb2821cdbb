/// Canonical moves for programs that read: one JSON object a line.
#pragma once

#include <string>

#include "plant/vocabulary/move.h"

namespace servomill::controllers {

/// One record, without a line end. Lengths in mm, angles in degrees, nine decimals.
///   t      rapid feed tap probe arc nurbs dwell tool spindle coolant stop end msg print
///   line   of the program, from 1
///   end, mend   [x,y,z,a,b,c] of motion, in work and in machine coordinates; z is null where it
///        depends on the length of a tool that is unknown
///   feed   mm/min if X, Y or Z moves, else deg/min; fmode "upm" (G94) or "inv" (G93)
///   feed, tap under G33, G33.1: sync, mm a revolution, in place of feed and fmode; tap: to its
///        depth and back, one record
///   arc: plane "XY" "YZ" "XZ"; center [c1,c2] in the order (X,Y) (Y,Z) (Z,X); mcenter [x,y,z];
///        turns as in `Arc`
///   nurbs: npts control points x, y (work coordinates) and weights; order (degree + 1); knots as
///        in SplineCurve
///   dwell: sec. tool: n. spindle: dir, rpm. coolant: mist, flood. stop: kind. msg, print: text.
std::string canon_json(const Move& move);
/// The same, behind what `out` holds.
void add_canon_json(const Move& move, std::string& out);

/// The record of a fault, as the last line.
std::string canon_error_json(const std::string& message);

}  // namespace servomill::controllers

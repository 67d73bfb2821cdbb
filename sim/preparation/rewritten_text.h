/// Rewritten programs as the text that leaves the simulation.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "controllers/gcode/program_setup.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/move_list.h"
#include "plant/vocabulary/put_move.h"
#include "plant/vocabulary/stored_text.h"

namespace servomill::sim::preparation {

struct RewrittenText {
  std::shared_ptr<const StoredText> text;
  MoveList moves;  // as read back; lines and arc lengths are those of the original
};

struct RewrittenTextRequest {
  std::string program_file;  // of the original
  std::string case_name;
  std::string header;  // comments, one a line
  JointLayout layout;
  controllers::ProgramSetup setup;
};

/// Writes the moves that `rewrite` hands out, and reads them like any program. Every motion, dwell,
/// tool change, stop and end must come back, in its order, with its position, feed, path mode,
/// work system, tool length, spindle and coolant; what the text cannot say, the position on the
/// original path, is carried over block by block. Neither text nor moves are in memory as a whole.
/// @throws InputError where it does not, and what `rewrite` throws
RewrittenText through_text(const std::function<void(const PutMove&)>& rewrite,
                           const RewrittenTextRequest& request);

}  // namespace servomill::sim::preparation

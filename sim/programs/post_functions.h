/// Functions of a post-processed program that is read back, held against those that its cutter
/// locations ask for: tools, spindle, coolant, dwells, stops and messages.
#pragma once

#include <deque>
#include <string>

#include "controllers/gcode/cl_data.h"
#include "sim/programs/post_kinematics.h"

namespace servomill::sim::programs {

class PostFunctions {
 public:
  /// @param options  with the height to retract to; outlive it
  explicit PostFunctions(const controllers::PostOptions& options) : options_(options) {}

  /// A tool that the program must load before any other.
  void expect_tool(int number) { tools_.push_back(number); }
  /// A record that is no motion, in the order of the cutter locations.
  void expect(const controllers::ClRecord& record);
  /// A tool change was expected since the last location.
  bool changes_tool() const { return changes_tool_; }

  /// A block of the program that is no motion.
  /// @param now        state of the machine, which the block changes
  /// @param off_place  a dwell here would not be at its location
  /// @return its fault, or empty
  std::string act(const Move& move, PostState& now, bool off_place);

  /// The fault of the state at a location, or empty; what is expected belongs to the next one.
  std::string arrive(const PostState& now);

  /// Something is still expected.
  bool is_pending() const { return !events_.empty() || !tools_.empty(); }

 private:
  bool is_safe() const { return options_.approach == controllers::Approach::safe; }
  std::string change_tool(const Move& move, PostState& now);
  std::string take_event(const Move& move, bool off_place);
  std::string fault_of(const PostState& now) const;

  const controllers::PostOptions& options_;
  std::deque<int> tools_;
  std::deque<const controllers::ClRecord*> events_;  // dwells, stops, messages
  PostState wanted_;                                 // tool, spindle and coolant of it
  int stopped_in_ = 0;                               // line; M6 and M30 stop the spindle, too
  bool changes_tool_ = false;
};

/// The machine is at the height to retract to.
bool is_retracted(const Joints& Q, const controllers::PostOptions& options);

}  // namespace servomill::sim::programs

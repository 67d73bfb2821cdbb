/// Entry of a setpoint correction into the NC: its place and its speed.
#pragma once

#include <cstdint>

namespace servomill {

enum class EntryPoint : std::uint8_t {
  before_filter,  // added to the interpolated position, passes the nominal-position filter, is fed
                  // forward
  position_command,  // added behind the feed-forward tap: only the position loop sees it
  feed_forward,      // added behind the filter, seen by position loop and feed-forward
};

/// The NC's answer to a value of the table: computed every `update_period` from the reference
/// position, delayed by `dead_time`, then a first-order lag of `time_constant`.
struct SetpointEntry {
  EntryPoint entry = EntryPoint::position_command;
  double time_constant = 0.0;  // s, >= 0
  double dead_time = 0.0;      // s, >= 0, rounded to whole position periods
  double update_period = 0.0;  // s, rounded up to whole position periods; 0: every one
};

}  // namespace servomill

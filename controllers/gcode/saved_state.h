/// State that M70 and M73 save, and M72 or the end of a subroutine restores.
#pragma once

#include <vector>

#include "controllers/gcode/modal_state.h"

namespace servomill::controllers {

/// The codes in force, as LinuxCNC saves them: not the motion code, no positions, no tool.
struct SavedModes {
  int normal_axis = 2;
  bool is_uvw_plane = false;
  double unit = mm;
  bool is_incremental = false, is_centre_absolute = false, retracts_to_r = true;
  FeedMode feed_mode = FeedMode::units_per_minute;
  int work_system = 1;
  bool has_tool_offset = false;
  bool controls_tip = false;
  PathMode path_mode = PathMode::continuous;
  double path_tolerance = 0.0;  // m
  double F = 0.0, S = 0.0;      // in program units and rev/min, as words
  int spindle_direction = 0;
  int coolant = 0;
  bool feed_override = true, adaptive_feed = false, feed_hold = true;
};

/// The saved modes of one level of calls.
struct SavedLevel {
  SavedModes modes;
  bool is_valid = false;            // M70 or M73 was there, and no M71 behind it
  bool restores_on_return = false;  // by M73
};

}  // namespace servomill::controllers

/// Heidenhain programs with the actions worked out by hand from the manuals that the reader's
/// header lists. Coordinates are those of the machine, in mm and degrees.
#pragma once

#include <string>
#include <vector>

#include "controllers/dialects/heidenhain_reader.h"

namespace servomill::controllers {

struct HeidenhainExample {
  std::string name;
  std::string program;
  /// One line for each action: line of the program, kind, axes. Commanded axes by themselves, the
  /// others in parentheses, unknown ones with '?'. Feed: F mm/min or deg/min, T s, R mm per
  /// revolution.
  std::string actions;
  HeidenhainSettings settings = {};
  ControlSetup setup = {};
};

/// Preset 1 at X200 Y250 Z-100, preset 2 at X300 Y100 Z-50, preset 3 at X10 Y20 Z30 and rotated by
/// 90 degrees; tool 1 is 50 mm long, tool 2 80 mm, the length of tool 3 is unknown. The place of
/// the axes at the start is unknown.
ControlSetup heidenhain_example_setup();

/// A program of these lines, numbered, with a frame that resets all cycles, calls tool 1 with S1000
/// and goes to X+0 Y+0. The first of these lines is line 14.
std::string heidenhain_program(const std::string& lines);
inline constexpr int kFrameLines = 13;

/// The actions in the form of HeidenhainExample::actions, lines counted after `frame_lines`; the
/// actions of the frame and M30 of `heidenhain_program` are left out.
std::string describe(const std::vector<MachineAction>& actions, int frame_lines = 0);

/// All examples. `actions` of those with a frame count lines after it.
std::vector<HeidenhainExample> heidenhain_line_examples();
std::vector<HeidenhainExample> heidenhain_circle_examples();
std::vector<HeidenhainExample> heidenhain_cycle_examples();
std::vector<HeidenhainExample> heidenhain_whole_examples();  // without the frame

}  // namespace servomill::controllers

/// Moves of conversational programs as text, one a line, for examples worked out by hand.
///
///     4 feed 10 20 -5 F500      line of the program, kind, X Y Z of the work system in mm, then
///                               rotary axes that are not at zero; F in mm/min or deg/min
///     7 arc 10 0 0 about 5 0 turns -1 F500   centre in its plane
#pragma once

#include <string>
#include <vector>

#include "controllers/gcode/program_setup.h"
#include "plant/vocabulary/move.h"

namespace servomill::controllers::conversational {

struct Example {
  std::string name;
  std::string program;  // lines behind the frame, or a whole program
  std::string moves;    // with lines counted behind the frame
};

/// Tool 1 is 100 mm long with radius 5, tool 2 50 mm with radius 10. The machine stands at zero.
ProgramSetup example_setup();

/// A program of these lines that calls tool 1 with S1000 and stands at X0 Y0 Z0 before them.
std::string with_frame(const std::string& lines);
inline constexpr int kFrameLines = 3;

/// Moves as text without those of the header and the end; lines are counted after the header.
std::string framed_moves(const std::string& lines, const ProgramSetup& setup = example_setup());
/// All moves of a program.
std::string all_moves(const std::string& program, const ProgramSetup& setup = example_setup());
std::string text_of(const std::vector<Move>& moves, int frame_lines = 0, int last_line = 1 << 30);

/// The message of the fault of lines behind the frame, lines counted from the begin of the file.
std::string fault_of(const std::string& lines, const ProgramSetup& setup = example_setup());

std::vector<Example> line_examples();
std::vector<Example> flow_examples();
std::vector<Example> circle_examples();
std::vector<Example> contour_examples();
std::vector<Example> cycle_examples();
std::vector<Example> transformation_examples();

}  // namespace servomill::controllers::conversational

/// Siemens programs and their moves as text (moves_text.h), worked out by hand from the manuals:
/// [F] 840D sl, Fundamentals, [J] Job Planning, [C] Cycles.
#pragma once

#include <string>
#include <vector>

#include "moves_text.h"

namespace servomill::controllers::siemens {

using conversational::Example;
using conversational::example_setup;

/// A program of these lines with G17 G71 G90 G94 G54 G64, tool 1, S1000, at X0 Y0 Z0 before them.
std::string with_frame(const std::string& lines);
inline constexpr int kFrameLines = 3;

/// Moves as text without those of the header and the end; lines are counted after the header.
std::string framed_moves(const std::string& lines, const ProgramSetup& setup = example_setup());
/// All moves of a program.
std::string all_moves(const std::string& program, const ProgramSetup& setup = example_setup());
/// Warnings of a program, one a line.
std::string warnings_of(const std::string& program, const ProgramSetup& setup = example_setup());
/// The message of the fault of lines behind the frame, lines counted from the begin of the file.
std::string fault_of(const std::string& lines, const ProgramSetup& setup = example_setup());

std::vector<Example> line_examples();
std::vector<Example> arc_examples();
std::vector<Example> contour_examples();
std::vector<Example> frame_examples();
std::vector<Example> flow_examples();
std::vector<Example> cycle_examples();

}  // namespace servomill::controllers::siemens

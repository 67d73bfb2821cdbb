/// A control before a program, and which of its positions the user has given.
#pragma once

#include <string>
#include <vector>

#include "controllers/gcode/program_setup.h"
#include "controllers/translation/translated_program.h"
#include "sim/programs/canonical_moves.h"
#include "sim/programs/known_positions.h"

namespace servomill::sim::programs {

/// Height (m) of an unknown start. Canned cycles compare their heights with the one before; where
/// nothing names that, it is above the workpiece, and none that a program would name.
inline constexpr double kSomeHeight = 1.23456789;

struct GivenSetup {
  controllers::ProgramSetup setup;
  GivenPlaces given;
  controllers::translation::Language language = controllers::translation::Language::gcode;
};

/// @param inputs        of the program, with its machine if there is one
/// @param work_offsets  "G54:X=10,Y=-5"
/// @param tool_lengths  "1=50"
/// @param layout        of the machine; nullptr: not known
/// @throws InputError
GivenSetup given_setup(const std::string& program_file, const ProgramInputs& inputs,
                       const std::vector<std::string>& work_offsets,
                       const std::vector<std::string>& tool_lengths, const JointLayout* layout);

}  // namespace servomill::sim::programs

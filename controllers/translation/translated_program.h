/// Programs in other languages than G-code: recognised, and translated to lines of G-code.
#pragma once

#include <set>
#include <string>

#include "controllers/gcode/program_setup.h"
#include "controllers/gcode/program_text.h"

namespace servomill::controllers::translation {

enum class Language { gcode, conversational, siemens };

/// The language that the reader takes the text for.
Language language_of(ProgramText& text, Reader reader);

/// Replaces a program in another language by equivalent lines of G-code, and the setup by the one
/// that fits them.
void translate(ProgramText& text, ProgramSetup& setup);

/// The setup for running G-code that was written from a program: `setup` itself, unless that
/// program is in another language.
ProgramSetup gcode_setup(ProgramText text, ProgramSetup setup);

/// Programs that a program in another language calls, by name without folder and extension.
std::set<std::string> called_programs(ProgramText text, Language language);

}  // namespace servomill::controllers::translation

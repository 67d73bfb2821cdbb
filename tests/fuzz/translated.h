/// Programs in other languages than G-code, read and run. Laws: a fault has its place in the
/// program; moves are finite, their lines are in the text, their lengths follow on each other; arcs
/// have directions.
#pragma once

#include <string_view>

#include "controllers/gcode/reader.h"

namespace servomill::fuzz {

/// @throws nothing but what a broken law throws
void run_translated(std::string_view text, std::string_view file, controllers::Reader reader);

}  // namespace servomill::fuzz

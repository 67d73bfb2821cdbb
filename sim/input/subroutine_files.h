/// Subroutines in files of their own.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "controllers/gcode/program_text.h"

namespace servomill::sim::input {

/// NAME.ngc in the folder of a program; NAME.H for a program called *.H. For a number, a program
/// called *.nc may have O0015.nc, O00015.nc or 15.nc in its place: the interpreter takes these by a
/// rule of other controls.
std::string subroutine_file(const std::string& program_file, const std::string& name);

/// Finds the file of a subroutine, called as above: beside the program, then in `folders`, in
/// their order. As LinuxCNC, folders within these are not looked into.
std::function<std::optional<controllers::ProgramText>(const std::string& name)> subroutine_files(
    const std::string& program_file, const std::vector<std::string>& folders);

}  // namespace servomill::sim::input

/// LinuxCNC's parameter file ("var" file): what numbered parameters are before a program runs.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace servomill::controllers {

/// Reads a file with a number and a value in each line, in increasing order of the numbers; values
/// of lengths in mm, of angles in degrees. Empty lines are left out, lines that begin with neither
/// a digit nor a sign are remarks, and so is what follows ';', '#' or '(' behind a value. What is
/// not named is 0. Any parameter may be missing. The file is never written.
/// @throws InputError with every faulty line: no number and value, a number outside of 1 ... 5601
/// or out of order, a value that is not finite, 5220 that is not a work system (1 ... 9); for a
/// file that is not empty and holds no parameter
std::map<int, double> parse_parameter_file(std::string_view text, const std::string& file);

/// The work system in force at the start (5220); 1 if the file does not say.
int work_system_of(const std::map<int, double>& stored);

}  // namespace servomill::controllers

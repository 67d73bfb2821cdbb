/// Texts in tests: lines, and the messages of faults.
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"

namespace servomill {

/// Lines without their ends.
inline std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

/// The text of lines, each with an end.
inline std::string joined(const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& line : lines) out += line + "\n";
  return out;
}

/// Messages of the faults that `action` throws, one a line and without their places; "" if it
/// throws none.
template <class Action>
std::string fault_messages(Action&& action) {
  try {
    action();
  } catch (const InputError& error) {
    std::string out;
    for (const Fault& fault : error.faults()) out += fault.message + "\n";
    return out;
  }
  return "";
}

}  // namespace servomill

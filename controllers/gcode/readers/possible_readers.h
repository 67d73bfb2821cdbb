/// The controls that a program can have been written for: those that would read all of it.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "controllers/gcode/interpreter.h"
#include "controllers/gcode/readers/differences.h"

namespace servomill::controllers {

class PossibleReaders {
 public:
  /// Runs the program once by the rules of each control.
  /// @param setup  that the program begins with; its reader does not count
  PossibleReaders(const ProgramText& text, const ProgramSetup& setup);

  /// The reading on which all controls agree that would read the program, or nullopt.
  std::optional<int> reading_of(WordDifference difference) const;
  /// "LinuxCNC would stop at line 4, grbl at line 5"
  std::string who_stops() const;

 private:
  struct Stop {
    std::string control;
    int line = 0;
  };

  std::uint8_t possible_ = 0;  // of `Reader`, a bit each
  std::vector<Stop> stops_;
};

}  // namespace servomill::controllers

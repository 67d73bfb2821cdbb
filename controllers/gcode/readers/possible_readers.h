/// The controls that a program can have been written for: those that would read all of it.
#pragma once

#include <array>
#include <optional>
#include <string>

#include "controllers/gcode/interpreter.h"
#include "controllers/gcode/readers/control_evidence.h"
#include "controllers/gcode/readers/differences.h"

namespace servomill::controllers {

/// A reading, and why it is that one: "since LinuxCNC would stop at line 4, grbl at line 5".
struct DeducedReading {
  int reading = 0;
  std::string why;
};

class PossibleReaders {
 public:
  /// Runs the program once by the rules of each control.
  /// @param setup  that the program begins with; its reader does not count
  PossibleReaders(const ProgramText& text, const ProgramSetup& setup);

  /// The reading on which all controls agree that would read the program; or on which those of them
  /// agree that the program itself names; or nullopt.
  std::optional<DeducedReading> reading_of(WordDifference difference) const;

 private:
  static std::optional<int> common_reading(WordDifference difference, std::uint8_t readers);
  std::string who_stops() const;

  struct Stop {
    std::string control;
    int line = 0;
  };

  std::uint8_t possible_ = 0;  // of `Reader`, a bit each
  std::vector<Stop> stops_;
  ControlEvidence evidence_;
};

}  // namespace servomill::controllers

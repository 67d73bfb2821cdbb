/// The highest position of Z that a program reaches at the workpiece.
#pragma once

#include <limits>
#include <string>

#include "controllers/gcode/interpreter.h"

namespace servomill::sim::programs {

class HighestZ {
 public:
  void look(const controllers::ExecutedBlock& block);

  /// A retract that goes down is none.
  /// @param retract  m, machine coordinate
  /// @throws InputError at the line that goes higher
  void refuse_above(double retract, const std::string& file) const;

 private:
  double Z_ = -std::numeric_limits<double>::infinity();  // m, machine coordinate
  int line_ = 0;
  bool has_last_ = false;  // Z has been named
  double last_ = 0.0;
};

}  // namespace servomill::sim::programs

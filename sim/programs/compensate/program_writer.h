/// Writer of a corrected program, one executed block after the other.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "controllers/gcode/interpreter.h"

namespace servomill::sim::programs {

class ProgramWriter {
 public:
  virtual ~ProgramWriter() = default;
  /// @throws InputError for what cannot be corrected, or not be expressed in this dialect
  virtual void write(const controllers::ExecutedBlock& block) = 0;
  /// The text.
  /// @param header  lines for its first comment
  virtual std::string finish(const std::vector<std::string>& header) = 0;
  /// Things that the operator has to make sure of at the control, one clause each.
  virtual std::vector<std::string> assumptions() const { return {}; }
  /// How positions are rounded, where that is coarser than the tolerance asks for; or empty.
  virtual std::string rounding() const { return {}; }
  /// Things left out or written from memory.
  virtual std::vector<std::string> warnings() const { return {}; }
};

}  // namespace servomill::sim::programs

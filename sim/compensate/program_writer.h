/// What writes a corrected program, one executed block after the other.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "controllers/gcode/interpreter.h"

namespace servomill::sim {

class ProgramWriter {
 public:
  virtual ~ProgramWriter() = default;
  /// @throws InputError for what cannot be corrected, or not be said in this dialect
  virtual void write(const controllers::ExecutedBlock& block) = 0;
  /// The text.
  /// @param header  lines for its first comment
  virtual std::string finish(const std::vector<std::string>& header) = 0;
};

}  // namespace servomill::sim

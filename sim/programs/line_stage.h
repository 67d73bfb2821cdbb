/// How far a program has been read.
#pragma once

#include <string>

#include "plant/vocabulary/progress.h"

namespace servomill::sim::programs {

/// Stage of a command that counts the lines of a program. Loops and subroutines go back to lines
/// that have been counted: then it stands still.
class LineStage {
 public:
  explicit LineStage(const std::string& file);
  void at(int line);

 private:
  Stage stage_;
  int farthest_ = 0;
};

}  // namespace servomill::sim::programs

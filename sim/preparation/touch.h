/// Touches of the probing moves of a program.
#pragma once

#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"

namespace servomill {
class MoveList;  // plant/vocabulary/move_list.h
}  // namespace servomill

namespace servomill::sim::preparation {

/// A probing move that has ended.
struct Touch {
  int line = 0;
  std::string section;              // of the program: what its last (MSG, ...) said
  Joints latched = Joints::Zero();  // m, rad; as the NC shows them
  bool has_switched = false;
};

/// The touches of a program with the sections in which they stand.
/// @param moves  of the program, the probing ones among them in the order of the touches
std::vector<Touch> with_sections(std::vector<Touch> touches, const MoveList& moves);

}  // namespace servomill::sim::preparation

/// Words that are repeated in a block.
#pragma once

#include "controllers/gcode/line_reader.h"

namespace servomill::controllers {

/// Blanks all but the last of equal words, and of F and S words also where they differ, where the
/// reader has that rule. Every character keeps its column.
void drop_repeated_words(TolerantLine& line, Reader reader);

}  // namespace servomill::controllers

/// Iterative learning control: the setpoints are offset against what earlier runs of the program
/// have shown.
#pragma once

#include "strategies/entry.h"

namespace servomill::strategies {

/// The machine of the case runs the program, each time with noise of its own; after each run the
/// offset is updated (strategies/learning_filter.h). The case is the run after the last update.
/// Recordings of an actual machine may take the place of these runs, each made with the offset
/// that was learnt from those before.
Entry learning_entry();

}  // namespace servomill::strategies

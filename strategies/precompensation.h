/// Predictive precompensation: the setpoints are offset against what an identified model of servo,
/// friction, structure and geometry predicts, before anything is cut.
#pragma once

#include "strategies/entry.h"

namespace servomill::strategies {

/// The model runs the program; what its tip deviates from the interpolated path is learnt from
/// (strategies/learning_filter.h) until the largest deviation is below the tolerance or no longer
/// falls. The best run decides.
Entry precompensation_entry();

}  // namespace servomill::strategies

/// Runs that a strategy has learnt from, and the offset that it has learnt, in the result file.
#pragma once

#include "plant/vocabulary/axes.h"
#include "sim/records/hdf5_group.h"
#include "sim/run/run_case.h"

namespace servomill::sim::run {

/// The group of the strategy below `all`.
void write_learnt(records::Hdf5Group& all, const LearntRuns& learnt, const JointLayout& layout);

}  // namespace servomill::sim::run

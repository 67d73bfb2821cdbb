/// Error models in result files, for figures and for people.
#pragma once

#include "sim/model/forward.h"
#include "sim/records/hdf5_group.h"

namespace servomill::sim::run {

/// Writes all error models of a scenario below /errors: MODEL/AXIS/ has the component errors of an
/// axis over its travel, MODEL/locations/ the location errors, each by its name of ISO 230-1. What
/// is zero is left out.
void write_errors(records::Hdf5Group& root, const model::Scenario& scenario);

}  // namespace servomill::sim::run

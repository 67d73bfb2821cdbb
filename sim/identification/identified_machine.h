/// The identified machine as a file: what was started from with the identified values over it.
#pragma once

#include <string>

#include "sim/input/write_identified.h"

namespace servomill::sim::identification {

struct Experiment;      // sim/identification/experiment.h
struct Identification;  // sim/identification/identification.h

/// The machine file: values of the machine (not of the recording's loop) with their
/// covariance; the unidentifiable by name only.
/// @param path  of the file, from which the machine that was started from is named
/// @throws InputError if the machine stands in the experiment, so that there is no file to lay over
input::IdentifiedFile identified_machine(const Experiment& experiment, const Identification& result,
                                         const std::string& path);

}  // namespace servomill::sim::identification

/// Reads the encoders of one axis, the reference marks of its scale and the error of its screw.
#pragma once

#include "sim/config/reader.h"
#include "sim/model/forward.h"

namespace servomill::sim::input {

/// Tables `scale`, `motor`, `marks` and `screw` of an axis, or the keys scale_step and motor_step.
/// @param noise_seed  of the machine; each encoder gets a stream of its own
/// @pre machine.nc.lower and upper are read
void read_encoders(config::Reader& axis, int joint, std::uint64_t noise_seed,
                   model::MachineSettings& machine);

}  // namespace servomill::sim::input

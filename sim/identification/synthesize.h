/// Recordings made up: what a control would have recorded of an axis that is known. For planning an
/// experiment, and for testing what an identification claims.
#pragma once

#include <cstdint>

#include "sim/identification/record.h"
#include "sim/identification/simulate_record.h"

namespace servomill::sim::identification {

/// Disturbances of a recording.
struct NoiseSettings {
  double force_rms = 0.0;      // N or N m: on the slide, Gaussian, correlated over force_time
  double force_time = 5e-3;    // s: the correlation falls to 1/e
  double feedback_step = 0.0;  // m or rad: of the encoders, in the loop and in the recording
  std::uint64_t seed = 1;
};

/// The recording of a model that follows the command of `motion`, with its disturbance and the
/// noise, which the recording does not hold. Equal for equal seeds.
/// @pre the motion has a command
Record synthesize(const Record& motion, const AxisModel& model, const NoiseSettings& noise);

}  // namespace servomill::sim::identification

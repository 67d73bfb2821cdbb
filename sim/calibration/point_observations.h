/// Observations of balls, spheres, nests of sensors and parts: points of the tool seen from the
/// table.
#pragma once

#include "sim/calibration/observation_builder.h"

namespace servomill::sim::calibration {

/// Adds the group at hand, of kind ball_bar, r_test, sphere, touch or part.
void add_point_observations(ObservationBuilder& builder);

}  // namespace servomill::sim::calibration

/// What a scenario asks of circular tests, against the circles that its program describes.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim {

struct Scenario;

/// Faults of quantities of a circular test: a section is not one turn of a circle in a principal
/// plane, its samples lie too far apart, an axis does not move in it, or a pair of sections is not
/// one circle in both directions.
/// @param positions  nominal tool centre point (in the workpiece, m) at the samples of a section
std::vector<Fault> circular_faults(
    const Scenario& scenario,
    const std::function<std::vector<Eigen::Vector3d>(const std::string&)>& positions);

}  // namespace servomill::sim

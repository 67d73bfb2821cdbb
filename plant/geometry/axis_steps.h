/// Contribution of one axis with its geometric errors to the way of the tool: steps of a program
/// for the kernels (volumetric_kernel.h).
#pragma once

#include <array>
#include <vector>

#include "plant/geometry/error_model.h"
#include "plant/geometry/volumetric_kernel.h"
#include "plant/kinematics/chain.h"

namespace servomill::plant {

/// Errors of an axis that grow with its coordinate, by direction.
using AxisFunctions = std::array<ErrorFunction, kErrorDirections>;

/// A linear axis goes along L d instead of d (L: its location errors, d: its direction), which thus
/// count as well.
AxisFunctions functions_of(const ChainAxis& axis, const ErrorModel& errors);

/// Steps of an axis, as the tool passes them. An inclined axis is entered and left through a frame
/// in which nothing is inclined and of which its centre is the origin.
std::vector<VolumetricStep> steps_of(const ChainAxis& axis, const ErrorModel& errors,
                                     const AxisFunctions& functions);

bool is_turn(const VolumetricStep& step);
bool is_frame(const VolumetricStep& step);
bool is_shift(const VolumetricStep& step);

}  // namespace servomill::plant

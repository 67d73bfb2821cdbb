/// Reads the drive of one axis of a machine: inertias, transmission, friction, motor.
#pragma once

#include "plant/drives/feed_drive.h"
#include "sim/config/reader.h"

namespace servomill::sim::input {

/// Names of the friction models as files write them, in the order of plant::FrictionKind.
std::span<const std::string_view> friction_models();

/// @param axis            the table of the axis
/// @param linear          lengths in m, else angles in rad
/// @param friction_model  of the machine, for an axis that names none
plant::FeedDriveParams read_drive(config::Reader& axis, bool linear,
                                  plant::FrictionKind friction_model);

}  // namespace servomill::sim::input

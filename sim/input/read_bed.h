/// Bed of a machine under an axis.
#pragma once

#include "plant/drives/feed_drive.h"
#include "sim/config/reader.h"

namespace servomill::sim::input {

/// Reads the table `machine_bed` of an axis, where there is one, into its drive.
/// @param base_period  s
void read_bed(config::Reader& axis, bool linear, double base_period, plant::FeedDriveParams& drive);

}  // namespace servomill::sim::input

/// Fastest rates of a feed drive, and the sub-steps that resolve them.
#pragma once

#include <string>
#include <vector>

#include "plant/drives/feed_drive.h"

namespace servomill::plant {

/// Largest rate (1/s) of the linear drive in any of its modes.
double fastest_rate_of(const FeedDriveParams& p);

/// Halvings of the base period (s) that give the finest sub-step: short enough to locate events,
/// and to advance by two terms of the Taylor series.
int halvings_of(const FeedDriveParams& p, double base_period);

/// Faults of parameters that the exact step cannot represent, each as a rule with the figures;
/// empty for parameters that it can. Values that no drive can have are faults of implausible().
std::vector<std::string> unrepresentable(const FeedDriveParams& params, double base_period);

}  // namespace servomill::plant

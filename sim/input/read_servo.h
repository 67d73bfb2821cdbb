/// Reads the servo loops of the axes of a machine, as its NC has them.
#pragma once

#include "controllers/servo/cascade.h"
#include "controllers/servo/filters.h"
#include "controllers/servo/position_feedback.h"
#include "sim/config/reader.h"
#include "sim/model/forward.h"

namespace servomill::sim::input {

/// Settings of all axes unless they have their own: keys of the table `nc`.
struct CommonServo {
  controllers::CascadeParams cascade;
  controllers::PositionFeedback feedback = controllers::PositionFeedback::scale;
  double crossover = 0.0;                 // Hz; 0: not given
  double following_error_linear = 10e-3;  // m
  double following_error_rotary = 0.0;    // rad
};
CommonServo read_common_servo(config::Reader& nc);

/// Filters of the list `filter` of a table, run once per `period` (s).
controllers::FilterChain read_filters(config::Reader& table, double period);

/// Cascade and functions of one axis, from its table.
/// @pre machine.drives and machine.nc.periods are read
void read_servo(config::Reader& axis, const CommonServo& common, int joint,
                model::MachineSettings& machine);

}  // namespace servomill::sim::input

/// State of a case at a record instant.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "plant/vocabulary/axes.h"

namespace servomill::sim::engine {

/// Everything that is recorded of one instant, SI.
struct Snapshot {
  double time = 0.0;
  double s = 0.0;
  std::size_t piece = 0;           // of the programmed path
  Joints Q_ref = Joints::Zero();   // interpolated
  Joints Q_cmd = Joints::Zero();   // after setpoint corrections
  Joints Q_fb = Joints::Zero();    // what the NC reads (virtual encoder)
  Joints Q_meas = Joints::Zero();  // what the scale says
  Joints Q_true = Joints::Zero();
  Joints dQ_true = Joints::Zero();
  Joints current = Joints::Zero();
  Joints torque = Joints::Zero();
  Eigen::Vector3d cutting_force = Eigen::Vector3d::Zero();  // N, on the cutter, in W
  Eigen::Vector3d deflection = Eigen::Vector3d::Zero();     // m, of the structure in linear axes
  double spindle_angle = 0.0;                               // rad, where teeth cut
  // m, the same by acceleration
  Eigen::Vector3d inertial_deflection = Eigen::Vector3d::Zero();
  Eigen::Vector3d bed = Eigen::Vector3d::Zero();  // m, displacement of the machine bed
  // set by the Recorder: number of the window, and 1 in it, 0 in rows around it
  double window = 0.0, in_window = 1.0;
};

}  // namespace servomill::sim::engine

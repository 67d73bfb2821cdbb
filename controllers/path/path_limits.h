/// Limits of the joints for the path planner, and its tolerances of the programmed path.
#pragma once

#include <cstddef>
#include <limits>

#include "plant/vocabulary/axes.h"

namespace servomill::controllers {

/// Largest absolute values on each joint; all > 0 for a joint that moves.
struct JointLimits {
  Joints v = Joints::Zero();  // m/s, rad/s
  Joints a = Joints::Zero();  // m/s^2, rad/s^2
  Joints j = Joints::Zero();  // m/s^3, rad/s^3
};

struct PathOptions {
  double tolerance = 10e-6;          // m, G64 without P
  double exact_tolerance = 0.1e-6;   // m, how far G61 may leave the path where it does not stop
  double exact_corner = 0.02;        // rad, G61 stops at sharper corners
  double rotary_tolerance = 100e-6;  // rad, norm over the rotary joints; for G61 scaled alike
  double rotary_radius = 0.1;        // m, turns rotary motion into path length
  double feed_override = 1.0;        // factor on feeds
  double rapid_override = 1.0;       // factor on the joint speeds of rapids
  double tolerance_share = 1.0;      // factor on tolerances of the program (G64 P)
  double spindle_acceleration = std::numeric_limits<double>::infinity();  // rad/s2, under G33
  double block_time = 0.0;      // s, least time of a block: what the NC needs to prepare it
  std::size_t stretch = 32768;  // vertices, above which a motion is planned in stretches
  std::size_t plans_in_memory = 32'000'000;  // bytes; what goes beyond is read when it is due
};

}  // namespace servomill::controllers

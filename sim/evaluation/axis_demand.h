/// Motion that one axis of a case was asked for, and the limits of the machine.
#pragma once

#include <array>

namespace servomill::sim::evaluation {

/// Largest value of a run, until it stopped.
struct DemandedValue {
  double size = 0.0;   // SI; lengths in m, angles in rad
  double limit = 0.0;  // of the axis
  double time = 0.0;   // s
  int line = 0;        // of the program
  double share() const { return size / limit; }
};

struct AxisDemand {
  char axis = '-';
  bool is_linear = true;
  double offset = 0.0;  // m, rad; largest that all strategies together add to the path
  std::array<DemandedValue, 3> motion;  // velocity, acceleration, jerk of path and offset together
};

}  // namespace servomill::sim::evaluation

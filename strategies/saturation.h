/// How long a limit held back a virtual displacement.
#pragma once

namespace servomill::strategies {

/// Saturation of the virtual displacement of one axis during one run.
struct Saturation {
  int joint = 0;
  bool of_rate = false;  // its rate of change was held back, else its size
  double limit = 0.0;    // m, rad or these per s
  double first = 0.0;    // s, since it was settled: when it began to act
  double time = 0.0;     // s, in all
};

}  // namespace servomill::strategies

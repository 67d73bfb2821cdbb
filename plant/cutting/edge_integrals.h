/// Integrals over angles of rotation that forces on edges consist of.
#pragma once

#include <cmath>

namespace servomill::plant {

/// Integrals over phi of 1, sin, cos, sin^2, sin cos.
struct EdgeIntegrals {
  double one = 0.0, sine = 0.0, cosine = 0.0, sine_squared = 0.0, sine_cosine = 0.0;

  /// Adds the range [from, to] (rad), if it is one.
  void add(double from, double to) {
    if (!(to > from)) return;
    one += to - from;
    sine += std::cos(from) - std::cos(to);
    cosine += std::sin(to) - std::sin(from);
    sine_squared += 0.5 * (to - from) - 0.25 * (std::sin(2.0 * to) - std::sin(2.0 * from));
    sine_cosine += 0.25 * (std::cos(2.0 * from) - std::cos(2.0 * to));
  }
};

}  // namespace servomill::plant

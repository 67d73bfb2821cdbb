/// Gains that are added to Kv in the position loops, and the margins that they have to leave.
#pragma once

#include <numbers>

namespace servomill {

/// C (1 + 1 / (Ti s)), added to the proportional gain of a position loop.
struct AddedGain {
  double C = 0.0;   // 1/s
  double Ti = 0.0;  // s; 0: no integral part
};

/// Margins of a position loop with an added gain.
struct WantedMargins {
  double phase = 0.25 * std::numbers::pi;  // rad
  double gain = 2.0;                       // factor by which the gain may rise
  double Ti = 0.0;                         // s, of an integral part; 0: none, or one with
  // Ti (Kv + C), Kv the largest of the axes: it costs about its inverse (rad) at the crossover
  double reset_ratio = 0.0;
};

}  // namespace servomill

/// The quantity of motion that the spindle turns with (G33, G33.1).
///
/// The NC interpolates the way x of the tool and the angle 2 pi x / lead of the spindle together.
/// The spindle is an axis under position control: in metres of the way it lags by lambda,
///   d lambda / dt = (1 - feed forward) dx/dt - Kv lambda,
/// whatever the lead. The tool deviates by its own lag, errors and dynamics; the synchronisation
/// error, deviation + lambda, is what a tap must take up. Equal gains of spindle and axis leave
/// nothing of the lags.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "plant/vocabulary/move_list.h"
#include "sim/evaluation/quantity.h"
#include "sim/model/machine.h"

namespace servomill::sim::evaluation {

/// A move that the spindle turns with, along the original path (m).
struct SynchronisedWay {
  double s_begin = 0.0, s_end = 0.0;
  bool goes_back = false;  // out of a tapped hole: the spindle turns on from its lag, reversed
};

/// Synchronised moves of a program, and the spindle that turns with them.
struct SpindleMotion {
  std::vector<SynchronisedWay> ways;  // in their order
  std::optional<model::SpindleDrive> drive;
};
SpindleMotion spindle_motion(const MoveRange& moves, const model::NcSettings& nc);

/// Lag of a spindle behind its setpoint along the way (m).
class SpindleLag {
 public:
  explicit SpindleLag(const model::SpindleDrive& drive);
  /// Moves on by dx (m) of the way in dt (s), at constant speed.
  void advance(double dx, double dt);
  /// The way turns back.
  void reverse() { lag_ = -lag_; }
  double value() const { return lag_; }

 private:
  double Kv_, share_, lag_ = 0.0;  // 1/s; of the speed that is not fed forward; m
};

std::span<const QuantityEntry> spindle_quantities();

}  // namespace servomill::sim::evaluation

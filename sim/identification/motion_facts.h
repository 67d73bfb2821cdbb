/// Facts of a motion that need no model of the drive: how far an axis lags behind its command on
/// ramps and circles, and what a reversal leaves.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/identification/record.h"

namespace servomill::sim::identification {

/// A part of constant commanded speed.
struct Ramp {
  double from = 0.0, to = 0.0;  // s
  double speed = 0.0;           // m/s
  double lag = 0.0;             // m, command less feedback, mean of its last third
};

/// Lag over speed: lag = time v + reversal sgn(v) + offset, by least squares over the ramps.
struct LagLaw {
  double time = 0.0, time_deviation = 0.0;          // s; 1/Kv without feed-forward and friction
  double reversal = 0.0, reversal_deviation = 0.0;  // m, half of the difference of the directions
};

/// A command that is a sine, as one axis of a circle has it.
struct SineFacts {
  double frequency = 0.0;  // Hz
  double amplitude = 0.0;  // m, of the command
  double gain = 0.0;       // amplitude of the feedback over that of the command
  double lag_time = 0.0;   // s
};

/// Greatest deviation of the lag from before a reversal of the command to after it.
struct Reversal {
  double time = 0.0;     // s
  bool to_plus = false;  // direction afterwards
  double peak = 0.0;     // m, beyond what the lag law gives
};

struct MotionFacts {
  std::vector<Ramp> ramps;
  std::optional<LagLaw> lag;
  std::optional<SineFacts> sine;
  std::vector<Reversal> reversals;
};

/// @pre the record has a command
MotionFacts motion_facts(const Record& record);

/// As lines of text; empty where the motion shows none of it.
std::string motion_facts_text(const MotionFacts& facts, bool is_rotary = false);

}  // namespace servomill::sim::identification

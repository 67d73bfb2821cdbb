/// Result of one case: how it ended, and its recording.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "sim/engine/stop_flag.h"
#include "sim/records/series.h"
#include "strategies/saturation.h"

namespace servomill::sim::engine {

/// How a case ended. A machine that stops is an outcome, not an exception.
struct Outcome {
  bool finished = true;
  bool interrupted = false;  // from outside
  std::string reason;        // "axis Y: following error beyond 10 mm"
  char axis = '-';
  double time = 0.0;  // s
};

/// Heat of a case, step after step of its thermal network.
struct HeatCourse {
  double step = 0.0;  // s; 0: a machine without heat
  std::size_t bodies = 0;
  std::vector<double> power;  // W, of each body, step after step
};

/// Largest size of a signal, and when.
struct Peak {
  double size = 0.0;
  double time = 0.0;  // s
};

/// Largest values in a run, joint by joint (SI; lengths in m, angles in rad).
struct AxisDemands {
  static constexpr std::size_t kOrders = 3;               // velocity, acceleration, jerk
  std::array<Peak, kJoints> offset;                       // of all strategies together
  std::array<std::array<Peak, kJoints>, kOrders> motion;  // of path and offset together
};

struct CaseResult {
  Outcome outcome;
  records::Series servo;       // one row a record period
  records::Series last_ticks;  // when stopped: what happened in the last position periods
  std::vector<strategies::Saturation> saturations;  // of the feedback
  HeatCourse heat;
  HeatCourse known_heat;              // as a strategy computes it; empty: none does
  std::vector<std::size_t> left_out;  // rows of feed motion outside the windows, by section
  double off_path = 0.0;              // m, CuttingLoad::off_path()
  AxisDemands demands;
  double simulated_time = 0.0;  // s
  double wall_time = 0.0;       // s, of all that ran in lockstep
};

}  // namespace servomill::sim::engine

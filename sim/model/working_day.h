/// A day of a machine that warms up: programs again and again, breaks, warming up.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"

namespace servomill::sim::model {

enum class Activity : std::uint8_t {
  idle,     // axes and spindle at rest
  spindle,  // the spindle turns, axes at rest
  program,  // the program of the scenario, again and again
  probe,    // datum at a place: from here on its drift is taken off
};

struct DayPhase {
  Activity activity = Activity::idle;
  double duration = 0.0;  // s; idle, spindle
  double spindle = 0.0;   // rad/s; spindle
  int cycles = 0;         // program
  int place = 0;          // probe: index of the place
};

/// Pose at which the drift of the tip is measured.
struct DayPlace {
  std::string name;
  Joints Q = Joints::Zero();                       // m, rad
  Eigen::Vector3d p_ST = Eigen::Vector3d::Zero();  // m, the measured point in the spindle
};

/// Datums in between the cycles of a program, as soon as the last one is older than `every`.
struct Remeasuring {
  int place = 0;            // index of the place
  double every = 0.0;       // s
  double duration = 120.0;  // s, of each, axes and spindle at rest
};

struct WorkingDay {
  std::vector<DayPhase> phases;
  std::vector<DayPlace> places;
  double sample = 60.0;      // s, between readings
  double probe_noise = 0.0;  // m, standard deviation of a datum along each axis
  std::uint64_t noise_seed = 0;
  std::optional<Remeasuring> remeasuring;
};

}  // namespace servomill::sim::model

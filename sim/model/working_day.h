/// A day of a machine that warms up: programs again and again, breaks, warming up.
#pragma once

#include <Eigen/Core>
#include <cstdint>
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

struct WorkingDay {
  std::vector<DayPhase> phases;
  std::vector<DayPlace> places;
  double sample = 60.0;  // s, between readings
};

}  // namespace servomill::sim::model

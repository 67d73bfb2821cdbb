/// Heat of a machine: bodies, where the heat comes from, what temperatures do to the geometry.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "plant/heat/thermal_errors.h"
#include "plant/heat/thermal_network.h"

namespace servomill::sim::model {

enum class HeatKind : std::uint8_t {
  constant,  // power, as long as the machine is on
  spindle,   // power by the speed of the spindle, linear between points
  motor,     // resistance times the square of the current of an axis
  friction,  // mechanical power of the motor of an axis and of the cut on it; kinetic energy, which
             // it includes, comes back within a cycle
};

/// Heat that one body receives.
struct HeatSource {
  std::string name;
  HeatKind kind = HeatKind::constant;
  int body = 0;
  double power = 0.0;          // W, constant
  plant::LinearTable spindle;  // W by the speed of the spindle in rad/s, from 0 on
  int joint = 0;               // motor, friction
  double resistance = 0.0;     // motor: ohm
  double share = 1.0;          // of the friction
};

/// A temperature sensor on a body.
struct HeatSensor {
  std::string name;
  int body = 0;
  double noise = 0.0;  // K, standard deviation of each reading
};

struct HeatSettings {
  plant::ThermalParams network;
  std::vector<HeatSource> sources;
  std::vector<plant::ThermalError> errors;
  std::vector<HeatSensor> sensors;
  std::uint64_t noise_seed = 0;          // of the sensors
  std::vector<double> coldest, warmest;  // K, of each body: beyond them the run ends
  double reference = 293.15;             // K, at which the machine has its errors
  std::vector<double> start;  // K, of each body; empty: settled, the machine on and at rest
  double clock = 0.0;         // s, time of the day at the start of a run
};

}  // namespace servomill::sim::model

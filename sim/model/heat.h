/// Heat of a machine: bodies, where the heat comes from, what temperatures do to the geometry.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
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
  cutting,   // power of the cut, at the edges
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
  double share = 1.0;          // of the friction, of the cutting power
};

/// The part, all of it at the temperature of one body, grows with it: points at p in the workpiece
/// are those at  p_0 + (p - p_0) / (1 + expansion (T - reference))  of the part when it is
/// measured.
struct PartExpansion {
  int body = 0;
  double expansion = 0.0;                           // 1/K
  Eigen::Vector3d fixed = Eigen::Vector3d::Zero();  // p_0, m, in W: where the part is held

  /// @param rise  K, above the reference
  Eigen::Vector3d measured(const Eigen::Vector3d& p_W, double rise) const {
    return fixed + (p_W - fixed) / (1.0 + expansion * rise);
  }
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
  std::vector<plant::ThermalError> sensor_errors;  // what a temperature compensation attributes to
                                                   // readings; `body` is the place of the sensor
  std::optional<PartExpansion> part;
  std::uint64_t noise_seed = 0;          // of the sensors
  std::vector<double> coldest, warmest;  // K, of each body: beyond them the run ends
  double reference = 293.15;             // K, at which the machine has its errors
  std::vector<double> start;  // K, of each body; empty: settled, the machine on and at rest
  double clock = 0.0;         // s, time of the day at the start of a run
};

}  // namespace servomill::sim::model

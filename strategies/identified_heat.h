/// Errors of a machine by its temperatures, as a strategy knows them.
#pragma once

#include <string>
#include <vector>

#include "plant/heat/thermal_errors.h"

namespace servomill::strategies {

/// ThermalError::body is the place of a temperature in a TemperatureReading.
struct IdentifiedHeat {
  std::vector<plant::ThermalError> by_body;    // of the thermal network that is known
  std::vector<plant::ThermalError> by_sensor;  // what is attributed to readings of sensors
  double reference = 293.15;                   // K, at which there are no such errors
};

}  // namespace servomill::strategies

/// Readings of temperature sensors with the drift of the tip.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "sim/model/forward.h"

namespace servomill::sim::calibration {

/// One reading. NaN: not measured.
struct HeatReading {
  Joints Q = Joints::Zero();                       // m, rad
  Eigen::Vector3d p_ST = Eigen::Vector3d::Zero();  // m, the measured point in the spindle
  std::vector<double> T;                           // K, of each sensor
  // m, along X, Y, Z of the machine, since any time that is the same for all readings at Q
  Eigen::Vector3d drift = Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
};

struct HeatReadings {
  std::string file;
  std::vector<std::string> sensors;  // names
  std::vector<HeatReading> rows;
};

/// Reads a table (sim/readings/columns.h) with the columns X_mm, ..., C_deg of every axis of the
/// machine, tool_mm (length; default 0), NAME_degC for each sensor and at least one of drift_X_um,
/// drift_Y_um, drift_Z_um, of which fields may be empty. Others are left alone.
/// @throws InputError with all faults: columns that are missing, sensors that the machine lacks,
/// fields that are no numbers
HeatReadings read_heat_readings(const std::string& path, const model::MachineSettings& machine);

}  // namespace servomill::sim::calibration

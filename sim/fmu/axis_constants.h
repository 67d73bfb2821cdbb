/// Constants of one exported axis, and the text file in which an FMU carries them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/model/machine.h"

namespace servomill::sim::fmu {

/// One axis of one case. Only the joint's own entries of `machine` count, and of the NC periods and
/// loops.
struct AxisConstants {
  std::string program;    // version that wrote them
  std::string scenario;   // name, without folder and extension
  std::string case_name;  // empty: the machine of the scenario
  std::string axis;       // its letter
  int joint = 0;
  double start = 0.0;      // m or rad, default setpoint
  Tick reading_delay = 0;  // ticks between the scale and what the position loop reads
  Tick record_period = 1;  // ticks; the drives of a run stop at each of them
  model::MachineSettings machine;

  bool linear() const { return joint < kLinearJoints; }
  /// A linear motor: what is a torque elsewhere is a force.
  bool linear_motor() const { return linear() && drive().kind == plant::DriveKind::direct; }
  const plant::FeedDriveParams& drive() const {
    return machine.drives[static_cast<std::size_t>(joint)];
  }
  plant::FeedDriveParams& drive() { return machine.drives[static_cast<std::size_t>(joint)]; }
  const controllers::CascadeParams& cascade() const {
    return machine.nc.cascade[static_cast<std::size_t>(joint)];
  }
  controllers::CascadeParams& cascade() {
    return machine.nc.cascade[static_cast<std::size_t>(joint)];
  }
};

/// Why an axis cannot be exported, to be put behind its name; empty if it can.
std::string why_not_exported(const AxisConstants& axis);

/// The file: `servomill axis 1`, then one line `key = value` for each constant, SI, in the order of
/// this version, decimal with as many digits as give the same bits again, and the CRC-64 (ECMA-182)
/// of all lines before it as `checksum = 0123456789abcdef`.
std::string text_of(const AxisConstants& axis);

/// Reads the file again, bit for bit.
/// @param name  of the file, for messages
/// @throws InputError for another version, a line that is not as written, or a wrong checksum
AxisConstants read_axis_constants(std::string_view text, const std::string& name);

/// The same of several axes, one text behind the other.
std::string text_of(const std::vector<AxisConstants>& axes);
std::vector<AxisConstants> read_axes(std::string_view text, const std::string& name);

/// Name of the file among the resources of an FMU.
inline constexpr std::string_view kAxisFile = "axis.txt";

/// Token that ties a model description to the constants: FMI's guid and instantiationToken.
std::string token_of(std::string_view text);

}  // namespace servomill::sim::fmu

/// Constants of one exported axis, and the text in which an FMU carries them.
#pragma once

#include <string>
#include <string_view>

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

/// The constants (sim/fmu/constants_text.h) behind the headline `servomill axis 2`, SI.
std::string text_of(const AxisConstants& axis);

/// Reads them again, bit for bit.
/// @param name  of the file, for messages
/// @throws InputError for another version, a line that is not as written, or a wrong checksum
AxisConstants read_axis_constants(std::string_view text, const std::string& name);

}  // namespace servomill::sim::fmu

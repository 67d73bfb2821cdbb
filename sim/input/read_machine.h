/// Reads a machine description (TOML).
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "plant/geometry/error_model.h"
#include "sim/config/reader.h"
#include "sim/model/machine.h"

namespace servomill::sim::input {

/// Machine of a table; faults are collected in the reader.
/// @param machine  table as documented in scenarios/machines/hsm600u.toml
/// @param errors   receives the error models that it holds, by name; nullptr: they are but checked
model::MachineSettings read_machine(config::Reader& machine,
                                    std::map<std::string, plant::ErrorModel>* errors = nullptr);

/// A machine file as programs and tables for a real machine need it.
struct MachineDescription {
  model::MachineSettings machine;  // without drives: structure, travel and what limits it gives
  std::map<std::string, plant::ErrorModel> errors;  // of the file's own [errors], by name
  bool has_drives = false;                          // all that a simulation needs
  std::optional<double> retract_Z;  // m; where Z is clear of everything (axis.Z.retract_mm)
};

/// A file without drives needs `structure` only; axes may have travel_*, v_max, a_max, j_max,
/// sense, direction, centre_mm, and Z retract_mm. A file with drives is read as that of any
/// simulation, with every check.
/// @param changes  "KEY=VALUE"
/// @throws InputError
MachineDescription read_machine_description(const std::string& path,
                                            const std::vector<std::string>& changes = {});

/// The same of a document that is complete.
MachineDescription described(const config::Document& document);

/// "X", "Y", ...: the table of an axis and what its quantities are called.
struct AxisQuantities {
  config::Quantity position, velocity, acceleration, jerk, force, load, stiffness, damping;
};
const AxisQuantities& quantities_of(bool linear);

/// Six program words such as X_mm = 1.5, C_deg = 90 (6; m, rad); absent ones are 0.
AxisWords read_words(config::Reader& table, const JointLayout& layout);

}  // namespace servomill::sim::input

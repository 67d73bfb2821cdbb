/// Reads a machine description (TOML).
#pragma once

#include <map>
#include <string>

#include "plant/geometry/error_model.h"
#include "sim/config/reader.h"
#include "sim/model/machine.h"

namespace servomill::sim::input {

/// Machine of a table; faults are collected in the reader.
/// @param machine  table as documented in scenarios/machines/hsm600u.toml
/// @param errors   receives the error models that it holds, by name; nullptr: they are but checked
model::MachineSettings read_machine(config::Reader& machine,
                                    std::map<std::string, plant::ErrorModel>* errors = nullptr);

/// "X", "Y", ...: the table of an axis and what its quantities are called.
struct AxisQuantities {
  config::Quantity position, velocity, acceleration, jerk, force, load, stiffness, damping;
};
const AxisQuantities& quantities_of(bool linear);

/// Six program words such as X_mm = 1.5, C_deg = 90 (6; m, rad); absent ones are 0.
AxisWords read_words(config::Reader& table, const JointLayout& layout);

}  // namespace servomill::sim::input

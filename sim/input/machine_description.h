/// Machine files as programs and tables for a real machine need them.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plant/geometry/error_model.h"
#include "sim/model/forward.h"

namespace servomill::sim::config {
class Document;  // sim/config/document.h
}  // namespace servomill::sim::config

namespace servomill::sim::input {

/// A machine file as programs and tables for a real machine need it.
struct MachineDescription {
  // without drives: structure, travel and what limits it gives
  std::shared_ptr<const model::MachineSettings> machine;
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

}  // namespace servomill::sim::input

/// From the files of a scenario to the one document that it is read from.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "sim/config/document.h"
#include "sim/config/reader.h"
#include "sim/input/input_files.h"

namespace servomill::sim::input {

/// A scenario with its machine in it.
struct ScenarioDocument {
  config::Document document;
  std::string machine_text;  // as read; empty if the scenario itself describes the machine
};

/// Reads a scenario, merged with those that it is based on.
/// @throws InputError
config::Document scenario_document(const std::string& path, InputFiles& files);

/// Puts the machine in, and the changes that --set asks for. `machine = "file"` is replaced by its
/// contents, overridden by `machine_override`. Changes of the file's name and of the overrides
/// come before, all others after, so that `machine.nc.Kv` means the value that counts.
/// @throws InputError
ScenarioDocument with_machine(config::Document scenario, std::span<const std::string> changes,
                              InputFiles& files);

/// True if a change acts before the machine is put in.
bool comes_before_machine(std::string_view change);

/// A path as it stands in a document: relative to that document, or, when it comes from --set, to
/// the folder in which the user is.
std::string beside(const Place& place, const std::string& path);

/// Tells if a table holds the contents of another file than the one it names: --set has changed the
/// name in a document that is complete by itself.
bool is_outdated_copy(config::Reader& table, std::string_view name, std::string_view contents);

/// { machine = table }, to override a document.
config::Value as_machine(config::Value table);

}  // namespace servomill::sim::input

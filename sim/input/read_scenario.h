/// Reads scenarios and machine files.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/model/forward.h"

namespace servomill {
class StoredText;
}  // namespace servomill

namespace servomill::sim::input {

struct ScenarioDocument;
class InputFiles;

/// Reads a scenario and the files that it names (paths relative to it).
/// @param changes  what --set says, in order
/// @throws InputError with all faults of a file at once
model::Scenario read_scenario(const std::string& path,
                              const std::vector<std::string>& changes = {});

/// The same for callers that need no complete Scenario.
std::shared_ptr<const model::Scenario> shared_scenario(
    const std::string& path, const std::vector<std::string>& changes = {});

/// Reads a resolved document and the program stored with it in a result file. The document contains
/// a short program itself, and the checksum of a long one.
/// @param program  nullptr: a long program is read from its file
model::Scenario read_resolved_scenario(const std::string& resolved, const std::string& name,
                                       std::shared_ptr<const StoredText> program = nullptr);

/// Common part of both: reads the document with the machine in it (sim/input/scenario_document.h).
/// @param files  where the program is looked for
model::Scenario read_document(ScenarioDocument scenario, const std::string& name,
                              InputFiles& files);

/// Only a machine, for `check`.
model::MachineSettings read_machine_file(const std::string& path);

}  // namespace servomill::sim::input

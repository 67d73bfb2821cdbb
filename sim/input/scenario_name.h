/// Scenarios and machines by name: "guevel2025/experiment1" is a file below the current folder or
/// of an installation.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/system/program_folder.h"

namespace servomill::sim::input {

/// Folders of scenarios that exist: `scenarios` of the current folder, then that of an
/// installation.
/// @param share  folder share/servomill of the installation
std::vector<std::string> scenario_folders(
    const std::filesystem::path& share = system::installed_share());

/// Names of the scenarios in a folder, relative to it and without ".toml", sorted; machines and
/// other files that cases refer to are none.
std::vector<std::string> scenario_names(const std::string& folder);

/// File of a scenario: `word` where it exists, else `word`.toml, else that of this name in the
/// first of the folders that has one. A word that is near to no name is returned as it is.
/// @throws InputError with the nearest names, if there are any
std::string scenario_file(const std::string& word, const std::vector<std::string>& folders);

/// File of a machine: as that of a scenario, or in the folder `machines` of one of the folders:
/// "hsm600u" and "machines/hsm600u" are the same.
std::string machine_file(const std::string& word, const std::vector<std::string>& folders);

}  // namespace servomill::sim::input

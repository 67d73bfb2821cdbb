/// Folders of the running program and of the installation that it belongs to.
#pragma once

#include <filesystem>

namespace servomill::sim::system {

/// Empty where the system does not tell.
std::filesystem::path program_folder();

/// Folder of data, share/servomill, of the installation that the running program belongs to: its
/// place relative to program_folder() is fixed, so that an installation may be moved. It need not
/// exist (there is none with a program in a build folder); empty where program_folder() is.
std::filesystem::path installed_share();

}  // namespace servomill::sim::system

/// The folder of the running program.
#pragma once

#include <filesystem>

namespace servomill::sim::system {

/// Empty where the system does not tell.
std::filesystem::path program_folder();

}  // namespace servomill::sim::system

/// Constants as an unpacked FMU has them, and the guard of its functions.
#pragma once

#include <exception>
#include <string>

#include "sim/fmu/machine_constants.h"

namespace servomill::sim::fmu {

/// Reads RESOURCES/axis.txt.
/// @param token  that the model description has
/// @throws InputError if there is none, or it belongs to another model description
MachineConstants machine_in(const std::string& resources, const std::string& token);

/// Path of the URI of a local file: file:///a%20b, file:/a or file://localhost/a; a text without
/// "file:" is a path already.
std::string path_of(const std::string& uri);

/// Result of `run`, which may throw; then `failed(message)`. No exception leaves the library.
template <class Run, class Failed>
auto guarded(Run run, Failed failed) noexcept -> decltype(run()) {
  try {
    return run();
  } catch (const std::exception& e) {
    return failed(e.what());
  } catch (...) {
    return failed("unknown exception");
  }
}

}  // namespace servomill::sim::fmu

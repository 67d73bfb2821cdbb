/// The zip file of an FMU.
#pragma once

#include <string>
#include <string_view>

#include "sim/fmu/model_description.h"

namespace servomill::sim::fmu {

/// Bytes of the FMU: model description, constants, library for Linux on x86-64. The same
/// constants and library give the same bytes.
/// @param library  bytes of the shared library
/// @pre there is an axis; why_not_exported is empty for each, and for the kinematics
/// @throws std::runtime_error if libzip fails
std::string fmu_bytes(FmiVersion version, const MachineConstants& machine,
                      std::string_view library);

}  // namespace servomill::sim::fmu

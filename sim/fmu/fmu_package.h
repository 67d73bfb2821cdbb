/// The zip file of an FMU.
#pragma once

#include <string>
#include <string_view>

#include "sim/fmu/model_description.h"

namespace servomill::sim::fmu {

/// Bytes of the FMU: model description, constants of the axis, library for Linux on x86-64. The
/// same axis and library give the same bytes.
/// @param library  bytes of the shared library
/// @pre why_not_exported(axis) is empty
/// @throws std::runtime_error if libzip fails
std::string fmu_bytes(FmiVersion version, const AxisConstants& axis, std::string_view library);

}  // namespace servomill::sim::fmu

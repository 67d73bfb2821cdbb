/// modelDescription.xml of an FMU.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace servomill::sim::fmu {

struct MachineConstants;  // sim/fmu/machine_constants.h

enum class FmiVersion : std::uint8_t { fmi2, fmi3 };

/// Name of the shared library without folder and extension: FMI's modelIdentifier.
inline constexpr std::string_view kModelIdentifier = "servomill_axis";

/// The description as FMI 2.0.4 (chapters 2.2 and 4.3) or 3.0.2 (2.4 and 4.3) asks for it.
/// @param token  of the constants, see token_of
std::string model_description(FmiVersion version, const MachineConstants& machine,
                              std::string_view token);

}  // namespace servomill::sim::fmu

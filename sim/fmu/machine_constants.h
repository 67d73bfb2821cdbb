/// Constants of what one FMU contains: axes, and the kinematics of a whole machine.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plant/geometry/error_model.h"
#include "plant/kinematics/chain.h"
#include "sim/fmu/axis_constants.h"

namespace servomill::sim::fmu {

/// Kinematics of a machine with its geometric errors.
struct KinematicConstants {
  plant::MachineChain chain;
  plant::ErrorModel errors;
  Eigen::Vector3d p_ST = Eigen::Vector3d::Zero();  // m, default tip in the spindle nose
};

/// Why they cannot be exported, to be put behind the name of the machine; empty if they can.
std::string why_not_exported(const KinematicConstants& kinematics,
                             const model::MachineSettings& machine);

struct MachineConstants {
  std::vector<AxisConstants> axes;
  std::optional<KinematicConstants> kinematics;  // then `axes` are all of the machine
};

/// Texts (sim/fmu/constants_text.h) of the axes, one behind the other, and behind the headline
/// `servomill kinematics 1` that of the kinematics.
std::string text_of(const MachineConstants& machine);

/// Reads them again, bit for bit.
/// @param name  of the file, for messages
/// @throws InputError
MachineConstants read_machine_constants(std::string_view text, const std::string& name);

/// Name of the file among the resources of an FMU.
inline constexpr std::string_view kConstantsFile = "axis.txt";

/// Token that ties a model description to the constants: FMI's guid and instantiationToken.
std::string token_of(std::string_view text);

}  // namespace servomill::sim::fmu

/// Contents of an FMU, by the options of `servomill fmu`.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace servomill::sim::fmu {
struct MachineConstants;  // sim/fmu/machine_constants.h
}  // namespace servomill::sim::fmu

namespace servomill::tools {

class Options;

struct FmuContents {
  std::shared_ptr<const sim::fmu::MachineConstants> machine;
  std::vector<std::string> axes;    // their letters
  std::vector<std::string> report;  // lines on each axis and on the tool
};

/// Reads the scenario of the command: one axis, several, or the whole machine.
/// @throws InputError for what cannot be exported, and for cases that do not agree
FmuContents fmu_contents(const Options& options);

/// Variables of an FMU, as the help lists them.
std::string fmu_variables();

}  // namespace servomill::tools

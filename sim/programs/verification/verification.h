/// Verification of written programs: each is read back as its control would read it, and compared
/// with the original before its file gets its name.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "controllers/dialects/machine_action.h"
#include "controllers/gcode/program_setup.h"
#include "controllers/gcode/program_text.h"
#include "sim/programs/compensate/compensate.h"
#include "sim/programs/compensate/correction.h"
#include "sim/programs/verification/original.h"
#include "sim/programs/verification/replay_comparison.h"

namespace servomill::sim::programs {

struct VerificationRequest {
  std::string original_file;
  std::optional<std::string> original_text;  // instead of the file's
  controllers::ProgramSetup setup;           // of the original
  controllers::ControlSetup control;         // entered by the operator of the other control
  Dialect dialect = Dialect::linuxcnc;
  JointLayout layout;
  std::array<bool, 3> is_endless{};  // A, B, C: without ends of travel
  std::vector<std::string> without;  // names of kFanucFunctions
  AxisFlags6 is_start_known{};
  ComparisonLimits limits;
};

struct VerificationReport {
  std::size_t blocks = 0;  // of the written program, as run
  double largest = 0.0;    // m, between its path and the corrected one
  int settings = 0;        // of the control
  std::string text() const;
};

/// Values that the operator enters: work offsets, lengths of the tools and the start.
/// @param is_work_system_known  of 9
controllers::ControlSetup control_setup(const controllers::ProgramSetup& setup,
                                        const std::array<bool, 9>& is_work_system_known,
                                        const AxisFlags6& is_start_known);

/// @throws InputError that shows the line of the original and that of the written program
VerificationReport verify_program(const std::string& written, const VerificationRequest& request,
                                  Correction& correction);

}  // namespace servomill::sim::programs

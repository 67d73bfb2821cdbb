/// A written program under every setting of its control that could change its effect.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "controllers/dialects/machine_action.h"
#include "sim/programs/compensate/compensate.h"

namespace servomill::sim::programs {

struct Reading {
  std::string settings;  // for messages
  std::function<std::vector<controllers::MachineAction>()> read;
};

/// Resolution of positions in the written program, m: Fanuc resolves 0.0001 inch where it
/// resolves 0.001 mm.
double written_grid(const std::string& text, Dialect dialect, double resolution);

struct ReadingOptions {
  double resolution = 1e-6;  // m; Fanuc: below 1 um only controls with IS-C come into question
  bool has_rotary_axes = false;
  std::array<bool, 3> is_endless{};  // A, B, C: axes that may be modulo axes
  std::vector<std::string> without;  // names of kFanucFunctions
};

/// @param text, setup  must outlive the readings
/// @pre dialect is not linuxcnc
std::vector<Reading> readings_of(const std::string& text, Dialect dialect,
                                 const controllers::ControlSetup& setup,
                                 const ReadingOptions& options);

}  // namespace servomill::sim::programs

/// A written program under every setting of its control that could change its effect.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "controllers/dialects/machine_action.h"
#include "sim/programs/compensate/compensate.h"

namespace servomill::sim {

struct Reading {
  std::string settings;  // for messages
  std::function<std::vector<controllers::MachineAction>()> read;
};

/// Resolution of positions in the written program, m: Fanuc resolves 0.0001 inch where it
/// resolves 0.001 mm.
double written_grid(const std::string& text, Dialect dialect, double resolution);

/// @param text, setup  must outlive the readings
/// @param resolution   m; Fanuc: below 1 um only controls with IS-C come into question
/// @param is_endless   A, B, C: axes that may be modulo axes
/// @pre dialect is not linuxcnc
std::vector<Reading> readings_of(const std::string& text, Dialect dialect,
                                 const controllers::ControlSetup& setup, double resolution,
                                 bool has_rotary_axes, std::array<bool, 3> is_endless);

}  // namespace servomill::sim

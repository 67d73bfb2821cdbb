/// Axes of small scenarios as an FMU has them.
#pragma once

#include <string>

#include "sim/fmu/exported_axis.h"
#include "sim/model/scenario.h"
#include "tests/sim/small_scenario.h"

namespace servomill::sim::fmu {

/// Friction, disturbed and noisy encoders, filters and compensations: little is left out.
inline const std::string kRichAxes =
    "[machine_override]\nfriction_model = \"lugre\"\n"
    "[machine_override.axis]\n"
    "Y.friction_compensation = { coulomb = \"450 N\" }\n"
    "Y.scale = { period = \"20 um\", subdivision = 1024, sine_offset = 0.01, "
    "position_noise = \"5 nm\" }\n"
    "Z.friction = { model = \"set_valued\" }\n"
    "Z.backlash = \"3 um\"\nZ.backlash_compensation = { width = \"3 um\" }\n";

inline constexpr const char* kMoves =
    "G21 G90 G94\nG1 X12 Y10 Z-5 F3000\nG1 X3 Y-8 Z4\nG1 X0 Y0 Z0\nM30\n";

inline model::Scenario rich_scenario(const std::string& more = "") {
  return small_scenario(kMoves, kRichAxes + "[record]\nresolution_nm = 0\nperiod_ms = 0.7\n" +
                                    more + "[[case]]\nname = \"plain\"\n");
}

}  // namespace servomill::sim::fmu

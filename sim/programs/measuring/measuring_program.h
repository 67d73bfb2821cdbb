/// Measuring programs of touch probes for controls, each read back before it gets its name.
#pragma once

#include <string>
#include <vector>

#include "sim/model/forward.h"
#include "sim/programs/compensate/dialect.h"
#include "sim/programs/measuring/measuring_steps.h"

namespace servomill::sim::programs {

struct MeasuringProgram {
  std::string text;
  std::vector<std::string> assumptions;  // the operator has to make sure of them
};

/// Prints the moves between the safe frames of the control: positions of the tip in G54, which lies
/// at the zero of the machine; the probe is tool 1, its length in the control's table.
/// @throws Unsayable
MeasuringProgram measuring_program(const MeasuringMoves& moves,
                                   const model::MachineSettings& machine,
                                   const ProbingSettings& settings, double length, Dialect dialect);

/// Reads a program as the control does, under every setting of its builder, and compares it with
/// the moves: kind, axes and end of each, feeds, tool length, and that no spindle turns.
/// @throws InputError with the line of the first difference
void verify_measuring_program(const MeasuringProgram& program, const MeasuringMoves& moves,
                              const model::MachineSettings& machine,
                              const ProbingSettings& settings, double length, Dialect dialect);

/// Prints, verifies and writes; what is not verified gets no name.
/// @return what the operator has to make sure of
/// @throws InputError
std::vector<std::string> write_measuring_program(const std::string& path,
                                                 const MeasuringMoves& moves,
                                                 const model::MachineSettings& machine,
                                                 const ProbingSettings& settings, double length,
                                                 Dialect dialect, bool force);

/// Files beside the programs for what they put out: readings of kind touch, without X, Y and Z, and
/// the group that names them.
void write_touches(const std::string& folder, const MeasuringMoves& moves,
                   const model::MachineSettings& machine, const ProbingSettings& settings,
                   double length, bool force);

/// "measure_100.ngc", ".h", ".nc", ".mpf" for a probe of 100 mm
std::string measuring_file(Dialect dialect, double length);

}  // namespace servomill::sim::programs

/// Writes readings as files.
#pragma once

#include <string>

#include "sim/readings/readings.h"

namespace servomill::sim::calibration {

/// Writes the file of readings and those of its groups into a folder, under their own names, which
/// must differ; the machine and everything else stays as it is said in the original. Every axis has
/// a column.
/// @param machine  file of the machine
/// @throws InputError if one of them may not be written
void write_readings(const std::string& folder, const readings::Readings& readings,
                    const plant::MachineChain& chain, const std::string& machine, bool force);

/// Writes a plan of what to measure as such files: every row with its place, its number missing.
/// The set-ups are numbered files; reading them as they are is refused, number by number.
/// @throws InputError if one of them may not be written
void write_plan(const std::string& folder, const readings::Readings& plan,
                const plant::MachineChain& chain, const std::string& machine, bool force);

}  // namespace servomill::sim::calibration

/// The signals of single points of a sweep.
#pragma once

#include <cstdint>
#include <string>

#include "sim/sweep/run_sweep.h"

namespace servomill::sim::sweep {

/// "OUT.series" for "OUT.h5": where the points' files lie.
std::string series_folder(const std::string& path);

/// True if the signals of a point lie there, complete and of this sweep and version.
bool has_point_series(const std::string& folder, const Sweep& sweep, std::uint64_t point);

/// Writes the signals of a point as `servomill run` would with its values: FOLDER/NUMBER.h5,
/// counted from 1. Replaces what an earlier try left there. Nothing, where the point has none.
/// @throws SystemError
void write_point_series(const std::string& folder, const Sweep& sweep, const SweepPoint& point);

}  // namespace servomill::sim::sweep

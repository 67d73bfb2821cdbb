/// A scenario run over a grid of one or two of its keys.
#pragma once

#include <string>
#include <vector>

#include "sim/run.h"

namespace servomill::sim {

/// One point of the grid: a value (TOML) for each key of the sweep, and the comparison there.
struct SweepPoint {
  std::vector<std::string> values;
  std::vector<ComparisonRow> rows;
  std::vector<std::string> stopped;  // "case NAME stopped: why"
};

/// Points of the grid; the last key varies fastest.
std::vector<std::vector<std::string>> grid_of(const Scenario& scenario);

/// Reads and prepares all points of a sweep.
/// @throws InputError at the point that is refused
void check_sweep(const std::string& scenario_path, const std::vector<std::string>& changes);

/// Reads the scenario anew for every point, with the values set as --set would, and runs it.
/// All points are read and prepared before the first one runs. A point that was interrupted is not
/// among those returned.
/// @throws InputError if there is no [sweep] table, or a point's value is refused
std::vector<SweepPoint> run_sweep(const std::string& scenario_path,
                                  const std::vector<std::string>& changes,
                                  const RunControl& control,
                                  const std::function<void(const SweepPoint&)>& point_done);

/// The number that a TOML value is, in the unit it is written in ("60 1/s" is 60); NaN if none.
double number_of(const std::string& toml);

}  // namespace servomill::sim

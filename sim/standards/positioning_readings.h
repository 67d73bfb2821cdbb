/// Readings of a positioning test from a file, arranged by target, direction and run.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/readings/readings.h"
#include "sim/standards/axis_positioning.h"

namespace servomill::sim::standards {

/// One approach of one target.
struct TargetReading {
  double target = 0.0;                                     // m, rad
  int direction = 0;                                       // 1 or -1
  int run = 0;                                             // from 0
  double deviation = 0.0;                                  // m, rad
  double time = std::numeric_limits<double>::quiet_NaN();  // s; NaN: not known
  Place place;
};

/// Readings as a test. Without times the readings follow each other as they are listed; where
/// several are in one line of the file, in the order of the standard's test cycle: each run all
/// targets upwards, then all downwards.
/// @throws InputError with all faults: a reading missing or given twice, targets that do not rise
/// or fall throughout, a target approached in one direction only
PositioningTest arrange(const std::vector<TargetReading>& readings, bool angular);

/// A test with remarks that a report has to print.
struct PositioningFile {
  PositioningTest test;
  std::string name;
  std::vector<std::string> remarks;
};

/// Reads one test from a table: columns `direction` (forward, backward), `target_mm` (`target_deg`)
/// and either a column a run, `p1`, `p2`, ... with actual positions, or `position_mm` or
/// `deviation_um` with one reading a row, `run` from 1 and, where known, `time_s`.
/// @throws InputError with all faults
PositioningFile read_positioning(const std::string& path);

/// A group of kind positioning: of an axis, or of a diagonal, whose targets count along the line
/// from its first row.
/// @throws InputError with all faults
PositioningFile positioning_of(const readings::Group& group, const JointLayout& layout);

/// Readings far from the others of their target and direction, at least three runs: more than ten
/// times the standard deviation that is usual at the other targets. One sentence each, with the
/// place. They count like all others.
std::vector<std::string> outliers(const std::vector<TargetReading>& readings, bool angular);

}  // namespace servomill::sim::standards

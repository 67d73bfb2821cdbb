/// Positioning tests from raw logs: recordings of target and position over time, and lists of
/// readings as test scripts of EPICS write them.
#pragma once

#include <string>
#include <string_view>

#include "sim/recordings/recording.h"
#include "sim/standards/positioning_readings.h"

namespace servomill::sim::standards {

/// How a log is read.
struct LogSettings {
  std::string target, position;  // channels, by name or by the end of it
  std::string unit;              // of the position; empty: as the log says, else that of the target
  double standstill = 1.0;       // s; a target that holds longer has been approached
};

/// One reading for each standstill of the target: the mean position in its second half, or what
/// held there. The direction is that from the target before; targets that are approached in one
/// direction only, where others are in both, are places to turn round at and left out, with a
/// remark. A constant difference of more than 5 mm is the zero of the instrument and taken away,
/// with a remark.
/// @throws InputError with all faults
PositioningFile positioning_of(const recordings::Recording& recording, const LogSettings& settings);

/// True for a text of assignments TGT_DATA[i], REF_DATA_FWD[i,run] and REF_DATA_BWD[i,run].
bool is_list_of_readings(std::string_view text);
/// Such a text; UNIT is that of all numbers (mm).
/// @throws InputError with all faults
PositioningFile parse_list_of_readings(std::string_view text, const std::string& file);

}  // namespace servomill::sim::standards

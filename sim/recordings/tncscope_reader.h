/// Recordings of Heidenhain TNCscope.
#pragma once

#include <string>
#include <string_view>

#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// True for a text with the sections %[GLOBAL] or %[CURVEn] before its first rows.
bool is_tncscope(std::string_view text);

/// A recording (.sco): a section %[CURVEn] for each curve with the keys CHANNELTYPE, AXISTYPE,
/// DIMENSION (unit), COUNT and CYCLETIME (us), then %[DATA] with rows "time;v1;v2", time in us.
/// Curves of a longer cycle time have empty fields between their samples and a base of their own.
/// @throws InputError with line and column; where a curve has not COUNT samples
Recording parse_tncscope(std::string_view text, const std::string& file);

/// True for a table with headings of TNCscope, such as "s actual X" or "i ist X".
bool is_tncscope_csv(std::string_view text);

/// A table (CSV) of TNCscope: a time without a unit is in us.
/// @throws InputError
Recording parse_tncscope_csv(std::string_view text, const std::string& file);

}  // namespace servomill::sim::recordings

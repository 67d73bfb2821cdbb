/// Traces of Sinumerik controls (XML).
#pragma once

#include <string>
#include <string_view>

#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// True for XML with the element traceData.
bool is_sinumerik_trace(std::string_view text);

/// Signals (`dataSignal`, in the order of f1, f2, ...) over the times (s) of the records (`rec`) of
/// traceData/dataFrame. Records are sparse: a value that is not there, or that is the control's
/// mark for none, is the one before; before the first one it is missing. Signals are named by
/// their description, or by their name where descriptions are missing or equal. The unit is
/// unitsType.
/// @throws InputError with the line of the element
Recording parse_sinumerik_trace(std::string_view text, const std::string& file);

}  // namespace servomill::sim::recordings

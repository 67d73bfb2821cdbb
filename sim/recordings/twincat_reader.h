/// Exports of TwinCAT Scope as text.
#pragma once

#include <string>
#include <string_view>

#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// True for rows of numbers under lines of a key and its values ("Name", "SymbolName").
bool is_twincat(std::string_view text);

/// Columns lie in groups: a time in ms and one or more channels, and the key of a line of the head
/// is repeated above every time. Each group is a base. Groups of a slower rate end earlier, have
/// empty fields or repeat their rows; a row that repeats time and values is taken once. Channels
/// are named by SymbolName, where it is there, else by Name; the key Unit gives their units. The
/// display offset and the scale factor of the head are not applied.
/// @throws InputError with line and column
Recording parse_twincat(std::string_view text, const std::string& file);

}  // namespace servomill::sim::recordings

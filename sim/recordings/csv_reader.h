/// Tables of numbers in text: any header, separators ; , tab or blanks, decimal point or comma.
#pragma once

#include <string>
#include <string_view>

#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// True for a text in which a row of numbers follows within the first lines.
bool is_csv(std::string_view text);

/// Reads a table. Separator and decimal sign are those that make the most of the first rows
/// numbers. The line above the first row holds the names, "name [unit]" or "name (unit)"; a line
/// of units may stand between. Lines in front of these and comments (#, %, //) are skipped. A
/// column called time, t or Zeit is the base, else rows are numbered. Empty fields and NaN are
/// missing samples.
/// @throws InputError with line and column
Recording parse_csv(std::string_view text, const std::string& file);

}  // namespace servomill::sim::recordings

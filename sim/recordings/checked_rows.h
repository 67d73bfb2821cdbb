/// Checks that all readers of text share: numbers of fields, times that ascend.
#pragma once

#include <cstddef>
#include <string_view>

#include "plant/vocabulary/input_error.h"
#include "sim/recordings/delimited_text.h"
#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// A number of a field; NaN for an empty one and for "NaN".
/// @throws InputError at `line` and the column of the field if it is none, or infinite
double checked_number(const Field& field, char decimal, const Place& line);

/// The decimal sign of a number that has one: ',' where only that makes it a number, else '.'.
char decimal_of(std::string_view number);

/// Appends an instant to a base.
/// @throws InputError if it is missing or not after the last one
void append_time(Base& base, double seconds, const Place& place);

/// Index of the base with these values; a new one, named "time", "time 2", ... if there is none.
std::size_t shared_base(Recording& recording, Base base);

}  // namespace servomill::sim::recordings

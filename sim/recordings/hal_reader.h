/// Recordings of LinuxCNC: halscope and halsampler.
#pragma once

#include <string>
#include <string_view>

#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// True for a text that begins with "Sampling period is ".
bool is_halscope(std::string_view text);

/// Saved data of halscope: the sampling period (ns, nSec), then a line for each sample of pins and
/// their values in turn, "joint.0.f-error +0.00012000000000 ...".
/// @throws InputError with line and column
Recording parse_halscope(std::string_view text, const std::string& file);

/// True for rows of numbers at blanks, without any heading, that are numbered one by one in the
/// first column or among which lines say "overrun".
bool is_halsampler(std::string_view text);

/// Output of halsampler, with sample numbers (-t) or without. Numbers that are left out are a gap;
/// an overrun without them leaves no time to the rows behind it and is refused. The file holds
/// neither names nor the sampling period.
/// @throws InputError with line and column
Recording parse_halsampler(std::string_view text, const std::string& file);

}  // namespace servomill::sim::recordings

/// Frequency measurements of Sinumerik controls (XML of the set-up and optimisation menu).
#pragma once

#include <string>
#include <string_view>

#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// True for XML with the element ResponseTestCustom.
bool is_sinumerik_frequency(std::string_view text);

/// Time series and spectra of a measurement: "signal 61 series 1" over time; "signal 61 auto
/// spectrum" and "signal 61 62 cross spectrum re", "... im" over the frequencies of the control. Of
/// these the notes give the error: the control divides its bandwidth by the number of lines less
/// one, but the lines of N samples at intervals T are 1/(N T) apart. Another note gives the
/// greatest difference between the control's responses conj(S_xy) / S_yy and those of its own
/// series at equal line, as a share of the greatest response and of that of the same
/// line: with X, Y the transforms of the series, averaged over the series,
///     S_yy = 4 mean |Y|^2 / N^2,  S_xy = 4 mean (conj(X) Y) / N^2
/// @throws InputError
Recording parse_sinumerik_frequency(std::string_view text, const std::string& file);

}  // namespace servomill::sim::recordings

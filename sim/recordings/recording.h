/// Recordings of real axes: channels over time or over frequency, as a control or a measuring
/// program has stored them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace servomill::sim::recordings {

/// Instants or frequencies at which channels were sampled. Channels of one rate share a base.
struct Base {
  std::string name = "time";
  std::string unit = "s";  // "s"; "Hz" for spectra; "1" for sample numbers, where no time is known
  std::vector<double> values;  // finite, ascending
  bool unit_known = true;      // false: a time without its unit, taken for s
};

/// One recorded quantity.
struct Channel {
  std::string name;
  std::string unit;             // as the file has it; empty: not known
  std::vector<double> samples;  // NaN: missing in the file
  std::size_t base = 0;         // index into Recording::bases
};

/// The content of one file.
struct Recording {
  std::string file;
  std::string format;  // "CSV, separator ';', decimal ','"
  std::vector<Base> bases;
  std::vector<Channel> channels;
  std::vector<std::string> notes;  // sentences on the content: skipped objects, assumed units
};

/// Base of samples whose times are not known: 0, 1, 2, ...
Base sample_numbers(std::size_t count);

/// Laws of every recording: a channel at least, names that differ, as many samples as the base has
/// instants, a base that ascends, no infinite values.
/// @throws InputError that names the file, the channel and the time
void check(const Recording& recording);

/// Gives times without a unit that one, or notes that they are taken for seconds.
/// @param unit  of time ("us"); empty: not given
/// @throws InputError if there is no such unit, or the file itself says which
void set_time_unit(Recording& recording, const std::string& unit);

/// "time 0.25 s", "sample 3", "frequency 10 Hz"; for messages.
std::string at_text(const Base& base, std::size_t index);

}  // namespace servomill::sim::recordings

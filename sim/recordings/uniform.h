/// Channels on a uniform grid of time, as identification takes them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// An interval of time between two samples that are there, with missing ones between them.
struct Interval {
  double from = 0.0, to = 0.0;  // s
  bool operator==(const Interval&) const = default;
};

/// Samples at the instants start + k period.
struct UniformChannel {
  std::string name, unit;
  double start = 0.0, period = 0.0;  // s
  std::vector<double> samples;
  std::vector<Interval> missing;  // bridged by a line: no longer than the gap allowed

  double time(std::size_t k) const { return start + static_cast<double>(k) * period; }  // s
};

/// The channel of that name.
/// @throws InputError with the nearest name if there is none
const Channel& channel_of(const Recording& recording, std::string_view name);

/// A channel at start + k period, linear between the samples next to each instant. The grid begins
/// at the first sample that is there and ends at or before the last one.
///     y(t) = y_i + (t - t_i) (y_{i+1} - y_i) / (t_{i+1} - t_i),  t_i <= t <= t_{i+1}
/// Instants that agree with a sample to 1e-9 of the period take it unchanged.
/// @param period   s, > 0
/// @param longest  s: greatest distance of neighbouring samples that a line may bridge
/// @throws InputError with channel and time: a name that is not there, a base that is no time, no
///         sample, a longer gap, a grid of more than 1e8 instants
UniformChannel uniform_channel(const Recording& recording, std::string_view name, double period,
                               double longest);

}  // namespace servomill::sim::recordings

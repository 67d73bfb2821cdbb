/// Properties of a recording that decide its use: rate, gaps, clipping, missing samples.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "sim/recordings/recording.h"

namespace servomill::sim::recordings {

/// Median of the differences of a base: the sampling interval of a recording with few gaps; 0 with
/// fewer than two values.
double interval(const Base& base);

/// Greatest deviation of a difference from the interval, gaps apart, as a share of the interval.
double jitter(const Base& base);

/// An interval of more than one and a half sampling intervals.
struct Gap {
  double from = 0.0, to = 0.0;  // last value before, first one after
  std::size_t missing = 0;      // samples that would fit between them
};
std::vector<Gap> gaps(const Base& base);

/// Samples held at the greatest or the least value of a channel.
struct Clipping {
  double level = 0.0;
  std::size_t runs = 0, samples = 0;
  std::size_t first = 0;  // index of the first sample of the first run
};

/// Runs of at least `kClippedRun` equal samples at the greatest or least value which the signal
/// enters or leaves abruptly: by more than half of its median change between samples. A position at
/// rest at the end of its travel arrives slowly and is not clipped, nor is a signal of a few quanta
/// at rest. A square wave cannot be distinguished from a clipped signal and is listed.
inline constexpr std::size_t kClippedRun = 3;
std::vector<Clipping> clipping(const Channel& channel);

/// Number of NaN.
std::size_t missing_samples(const Channel& channel);

/// The text that `servomill recording` prints.
std::string survey(const Recording& recording);

/// The same as one JSON object.
std::string survey_json(const Recording& recording);

}  // namespace servomill::sim::recordings

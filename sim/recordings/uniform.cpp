#include "sim/recordings/uniform.h"

#include <fmt/format.h>

#include <cassert>
#include <cmath>

#include "plant/vocabulary/input_error.h"
#include "sim/recordings/survey.h"

namespace servomill::sim::recordings {
namespace {

constexpr double kAgree = 1e-9;       // of the period: rounding of times such as 0.1 + 0.2
constexpr double kMaxInstants = 1e8;  // 0.8 GB

// Samples that are there, and between which of them some are not.
struct Present {
  std::vector<double> times, samples;
  std::vector<Interval> missing;
};

Present present(const Base& base, const Channel& channel) {
  Present out;
  bool any_missing = false;
  for (std::size_t i = 0; i < channel.samples.size(); ++i) {
    if (std::isnan(channel.samples[i])) {
      any_missing = !out.times.empty();
      continue;
    }
    if (any_missing) out.missing.push_back({out.times.back(), base.values[i]});
    any_missing = false;
    out.times.push_back(base.values[i]);
    out.samples.push_back(channel.samples[i]);
  }
  return out;
}

// Adds the gaps of the base to the intervals of missing samples, in the order of time.
void add_gaps(const Base& base, Present& known) {
  const double step = interval(base);
  std::vector<Interval> all;
  std::size_t next = 0;
  for (std::size_t i = 1; i < known.times.size(); ++i) {
    const Interval here{known.times[i - 1], known.times[i]};
    if (next < known.missing.size() && known.missing[next] == here) {
      all.push_back(here);
      ++next;
    } else if (here.to - here.from > 1.5 * step) {
      all.push_back(here);
    }
  }
  known.missing = std::move(all);
}

void refuse_gaps(const Recording& recording, const Channel& channel, const Present& known,
                 double longest) {
  for (std::size_t i = 1; i < known.times.size(); ++i) {
    const double from = known.times[i - 1], to = known.times[i];
    if (to - from <= longest) continue;
    throw InputError({recording.file},
                     fmt::format("channel '{}' has no sample between time {} s and {} s; at most "
                                 "{} s may be bridged",
                                 channel.name, from, to, longest));
  }
}

void fill(const Present& known, UniformChannel& out) {
  const double agree = kAgree * out.period;
  const double count = std::floor((known.times.back() - out.start + agree) / out.period);
  std::size_t i = 0;  // of the last sample at or before the instant
  for (std::size_t k = 0; static_cast<double>(k) <= count; ++k) {
    const double t = out.time(k);
    while (i + 1 < known.times.size() && known.times[i + 1] <= t + agree) ++i;
    if (i + 1 == known.times.size() || std::abs(t - known.times[i]) <= agree) {
      out.samples.push_back(known.samples[i]);
      continue;
    }
    const double share = (t - known.times[i]) / (known.times[i + 1] - known.times[i]);
    out.samples.push_back(known.samples[i] + share * (known.samples[i + 1] - known.samples[i]));
  }
}

}  // namespace

const Channel& channel_of(const Recording& recording, std::string_view name) {
  std::vector<std::string_view> names;
  for (const Channel& channel : recording.channels) {
    if (channel.name == name) return channel;
    names.push_back(channel.name);
  }
  throw InputError({recording.file},
                   fmt::format("has no channel '{}'{}", name, did_you_mean(name, names)));
}

UniformChannel uniform_channel(const Recording& recording, std::string_view name, double period,
                               double longest) {
  assert(period > 0.0 && longest > 0.0);
  const Channel& channel = channel_of(recording, name);
  const Base& base = recording.bases.at(channel.base);
  if (base.unit != "s") {
    throw InputError({recording.file},
                     fmt::format("channel '{}' has no times: its base is {}", channel.name,
                                 base.unit == "1" ? "sample numbers" : "in " + base.unit));
  }
  Present known = present(base, channel);
  if (known.times.empty()) {
    throw InputError({recording.file}, fmt::format("channel '{}' has no sample", channel.name));
  }
  refuse_gaps(recording, channel, known, longest);
  add_gaps(base, known);
  UniformChannel out{channel.name, channel.unit, known.times.front(), period, {}, {}};
  if ((known.times.back() - out.start) / period > kMaxInstants) {
    throw InputError({recording.file},
                     fmt::format("channel '{}': {} s in periods of {} s are more than 1e8 samples",
                                 channel.name, known.times.back() - out.start, period));
  }
  fill(known, out);
  out.missing = std::move(known.missing);
  return out;
}

}  // namespace servomill::sim::recordings

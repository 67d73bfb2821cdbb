#include "sim/recordings/recording.h"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numeric>

#include "plant/vocabulary/input_error.h"
#include "sim/recordings/delimited_text.h"
#include "sim/system/counted.h"

namespace servomill::sim::recordings {
namespace {

void check_base(const Recording& recording, const Base& base) {
  for (std::size_t i = 0; i < base.values.size(); ++i) {
    if (!std::isfinite(base.values[i])) {
      throw InputError({recording.file},
                       fmt::format("{}: value {} is not finite", base.name, i + 1));
    }
    if (i == 0 || base.values[i] > base.values[i - 1]) continue;
    throw InputError({recording.file},
                     fmt::format("{}: value {} is {} {} after {} {}; must increase", base.name,
                                 i + 1, base.values[i], base.unit, base.values[i - 1], base.unit));
  }
}

void check_channel(const Recording& recording, const Channel& channel) {
  const Base& base = recording.bases.at(channel.base);
  if (channel.samples.size() != base.values.size()) {
    throw InputError({recording.file},
                     fmt::format("channel '{}' has {}, its {} has {}", channel.name,
                                 system::counted(channel.samples.size(), "sample"), base.name,
                                 system::counted(base.values.size(), "value")));
  }
  for (std::size_t i = 0; i < channel.samples.size(); ++i) {
    if (!std::isinf(channel.samples[i])) continue;
    throw InputError({recording.file},
                     fmt::format("channel '{}' is infinite at {}", channel.name, at_text(base, i)));
  }
}

}  // namespace

Base sample_numbers(std::size_t count) {
  Base out{"sample", "1", std::vector<double>(count)};
  std::iota(out.values.begin(), out.values.end(), 0.0);
  return out;
}

void set_time_unit(Recording& recording, const std::string& unit) {
  const auto seconds = seconds_of(unit);
  if (!unit.empty() && !seconds) {
    throw InputError({"--time-unit"},
                     fmt::format("'{}' is not a unit of time; known are {}", unit, kTimeUnits));
  }
  bool is_used = unit.empty();
  for (Base& base : recording.bases) {
    if (base.unit_known) continue;
    for (double& value : base.values) value *= seconds.value_or(1.0);
    base.unit_known = is_used = true;
    recording.notes.push_back(
        unit.empty()
            ? fmt::format(
                  "the file has no unit of its {}: s is assumed; --time-unit specifies another",
                  base.name)
            : fmt::format("the {} is in {}, by --time-unit", base.name, unit));
  }
  if (is_used) return;
  throw InputError({recording.file}, "has a unit for every time; --time-unit does not apply");
}

std::string at_text(const Base& base, std::size_t index) {
  if (base.unit == "1") return fmt::format("sample {}", base.values[index]);
  return fmt::format("{} {} {}", base.unit == "s" ? "time" : base.name, base.values[index],
                     base.unit);
}

void check(const Recording& recording) {
  if (recording.channels.empty()) throw InputError({recording.file}, "contains no channel");
  for (const Base& base : recording.bases) check_base(recording, base);
  std::map<std::string, std::size_t> seen;
  for (std::size_t i = 0; i < recording.channels.size(); ++i) {
    const Channel& channel = recording.channels[i];
    const auto [first, is_new] = seen.try_emplace(channel.name, i);
    if (!is_new) {
      throw InputError({recording.file}, fmt::format("channels {} and {} are both called '{}'",
                                                     first->second + 1, i + 1, channel.name));
    }
    check_channel(recording, channel);
  }
}

}  // namespace servomill::sim::recordings

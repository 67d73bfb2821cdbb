#include "sim/recordings/recording.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "plant/vocabulary/input_error.h"
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
                     fmt::format("{}: value {} is {} {} after {} {}; must ascend", base.name, i + 1,
                                 base.values[i], base.unit, base.values[i - 1], base.unit));
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

std::string at_text(const Base& base, std::size_t index) {
  if (base.unit == "1") return fmt::format("sample {}", base.values[index]);
  return fmt::format("{} {} {}", base.unit == "s" ? "time" : base.name, base.values[index],
                     base.unit);
}

void check(const Recording& recording) {
  if (recording.channels.empty()) throw InputError({recording.file}, "holds no channel");
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

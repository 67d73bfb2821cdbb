#include "sim/recordings/survey.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/system/counted.h"
#include "sim/system/text_table.h"

namespace servomill::sim::recordings {
namespace {

constexpr double kGap = 1.5;           // sampling intervals
constexpr double kFewestQuanta = 8.0;  // range of a signal that moves

double median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Changes between samples that tell an abrupt change from a slow one.
struct Changes {
  double median = 0.0, quantum = 0.0;
};

Changes changes(const std::vector<double>& samples) {
  std::vector<double> found;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const double change = std::abs(samples[i] - samples[i - 1]);
    if (change > 0.0) found.push_back(change);  // false for NaN
  }
  if (found.empty()) return {};
  const double quantum = *std::min_element(found.begin(), found.end());
  return {median(found), quantum};
}

// True if the run [first, end) is entered or left abruptly.
bool is_abrupt(const std::vector<double>& samples, std::size_t first, std::size_t end,
               const Changes& usual) {
  const double enough = 0.5 * usual.median;
  double change = 0.0;
  // two differences each: the one at the limit may be cut short
  for (std::size_t k = 0; k < 2; ++k) {
    if (first >= k + 1) {
      change = std::max(change, std::abs(samples[first - k] - samples[first - k - 1]));
    }
    if (end + k < samples.size()) {
      change = std::max(change, std::abs(samples[end + k] - samples[end + k - 1]));
    }
  }
  return change > enough;
}

Clipping clipping_at(const std::vector<double>& samples, double level, const Changes& usual) {
  Clipping out;
  out.level = level;
  for (std::size_t i = 0; i < samples.size();) {
    std::size_t end = i;
    while (end < samples.size() && samples[end] == level) ++end;
    if (end - i >= kClippedRun && is_abrupt(samples, i, end, usual)) {
      if (out.runs++ == 0) out.first = i;
      out.samples += end - i;
    }
    i = std::max(end, i + 1);
  }
  return out;
}

std::string base_text(const Base& base) {
  const std::size_t count = base.values.size();
  if (base.unit == "1") return system::counted(count, "sample") + ", times not known";
  if (count == 0) return "no samples";
  const double step = interval(base);
  std::string out = fmt::format("{}, {:.6g} to {:.6g} {}", system::counted(count, "sample"),
                                base.values.front(), base.values.back(), base.unit);
  if (count < 2) return out;
  if (base.unit == "s") {
    out += fmt::format(", every {:.6g} ms ({:.6g} Hz)", step * 1e3, 1.0 / step);
  } else {
    out += fmt::format(", every {:.6g} {}", step, base.unit);
  }
  if (const double irregular = jitter(base); irregular > 1e-3) {
    out += fmt::format(", intervals vary by {:.2g} %", 100.0 * irregular);
  }
  return out;
}

std::string gaps_text(const Base& base) {
  std::string out;
  const std::vector<Gap> all = gaps(base);
  constexpr std::size_t kShown = 5;
  for (std::size_t i = 0; i < std::min(all.size(), kShown); ++i) {
    out += fmt::format("    gap: {:.6g} to {:.6g} {}, {} missing\n", all[i].from, all[i].to,
                       base.unit, system::counted(all[i].missing, "sample"));
  }
  if (all.size() > kShown) {
    out += fmt::format("    and {} more\n", system::counted(all.size() - kShown, "gap"));
  }
  return out;
}

std::string clipping_text(const Recording& recording, const Channel& channel) {
  std::string out;
  for (const Clipping& one : clipping(channel)) {
    if (!out.empty()) out += "; ";
    out += fmt::format("{} at {:.6g}, first at {}", system::counted(one.samples, "sample"),
                       one.level, at_text(recording.bases[channel.base], one.first));
  }
  return out.empty() ? "-" : out;
}

std::vector<std::string> channel_cells(const Recording& recording, const Channel& channel) {
  double least = std::numeric_limits<double>::quiet_NaN(), greatest = least;
  for (const double sample : channel.samples) {
    least = std::fmin(least, sample);
    greatest = std::fmax(greatest, sample);
  }
  const auto number = [](double value) {
    return std::isnan(value) ? std::string("-") : fmt::format("{:.6g}", value);
  };
  return {channel.name,
          channel.unit.empty() ? "?" : channel.unit,
          number(least),
          number(greatest),
          fmt::format("{}", missing_samples(channel)),
          clipping_text(recording, channel)};
}

}  // namespace

double interval(const Base& base) {
  std::vector<double> differences;
  for (std::size_t i = 1; i < base.values.size(); ++i) {
    differences.push_back(base.values[i] - base.values[i - 1]);
  }
  return median(differences);
}

double jitter(const Base& base) {
  const double step = interval(base);
  double greatest = 0.0;
  for (std::size_t i = 1; i < base.values.size(); ++i) {
    const double difference = base.values[i] - base.values[i - 1];
    if (difference > kGap * step) continue;
    greatest = std::max(greatest, std::abs(difference - step));
  }
  return step > 0.0 ? greatest / step : 0.0;
}

std::vector<Gap> gaps(const Base& base) {
  const double step = interval(base);
  std::vector<Gap> out;
  for (std::size_t i = 1; i < base.values.size(); ++i) {
    const double from = base.values[i - 1], to = base.values[i];
    if (to - from <= kGap * step) continue;
    constexpr double kMax = 1e15;  // far below what a count can hold
    const double fits = std::min(std::round((to - from) / step) - 1.0, kMax);
    out.push_back({from, to, static_cast<std::size_t>(fits)});
  }
  return out;
}

std::vector<Clipping> clipping(const Channel& channel) {
  double least = std::numeric_limits<double>::infinity(), greatest = -least;
  for (const double sample : channel.samples) {
    if (sample < least) least = sample;
    if (sample > greatest) greatest = sample;
  }
  std::vector<Clipping> out;
  if (!(least < greatest)) return out;  // constant, or nothing
  const Changes usual = changes(channel.samples);
  if (greatest - least < kFewestQuanta * usual.quantum) return out;
  for (const double level : {least, greatest}) {
    const Clipping found = clipping_at(channel.samples, level, usual);
    if (found.runs > 0) out.push_back(found);
  }
  return out;
}

std::size_t missing_samples(const Channel& channel) {
  return static_cast<std::size_t>(std::count_if(channel.samples.begin(), channel.samples.end(),
                                                [](double sample) { return std::isnan(sample); }));
}

std::string survey(const Recording& recording) {
  std::string out = fmt::format("{}: {}\n", recording.file, recording.format);
  for (std::size_t b = 0; b < recording.bases.size(); ++b) {
    const Base& base = recording.bases[b];
    out += fmt::format("  {}: {}\n{}", base.name, base_text(base), gaps_text(base));
    std::vector<std::vector<std::string>> lines = {
        {"channel", "unit", "min", "max", "missing", "clipped"}};
    for (const Channel& channel : recording.channels) {
      if (channel.base == b) lines.push_back(channel_cells(recording, channel));
    }
    out += system::text_table(std::move(lines), 0, {2, 3, 4});
  }
  for (const std::string& note : recording.notes) out += fmt::format("  note: {}\n", note);
  return out;
}

}  // namespace servomill::sim::recordings

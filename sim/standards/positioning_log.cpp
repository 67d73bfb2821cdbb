#include "sim/standards/positioning_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "plant/vocabulary/units.h"
#include "sim/config/quantity.h"
#include "sim/recordings/delimited_text.h"

namespace servomill::sim::standards {
namespace {

using recordings::Channel;
using recordings::Recording;

constexpr std::string_view kTarget = "TGT_DATA[", kForward = "REF_DATA_FWD[",
                           kBackward = "REF_DATA_BWD[", kUnit = "UNIT=";

// The channel of that name, or the only one whose name ends so.
const Channel& channel_of(const Recording& recording, const std::string& name, const char* option) {
  std::vector<const Channel*> found;
  std::vector<std::string_view> names;
  for (const Channel& channel : recording.channels) {
    if (channel.name == name) return channel;
    if (channel.name.ends_with(name)) found.push_back(&channel);
    names.push_back(channel.name);
  }
  if (found.size() == 1) return *found.front();
  throw InputError({recording.file},
                   found.empty() ? fmt::format("has no channel {} ({}){}; it has {}", name, option,
                                               did_you_mean(name, names), fmt::join(names, ", "))
                                 : fmt::format("has {} channels whose names end with {} ({}): {}",
                                               found.size(), name, option, fmt::join(names, ", ")));
}

struct Samples {
  std::vector<double> time, value;
};

Samples samples_of(const Recording& recording, const Channel& channel) {
  Samples out;
  for (std::size_t i = 0; i < channel.samples.size(); ++i) {
    if (std::isnan(channel.samples[i])) continue;
    out.time.push_back(recording.bases[channel.base].values[i]);
    out.value.push_back(channel.samples[i]);
  }
  if (out.time.empty()) {
    throw InputError({recording.file}, fmt::format("channel {} has no values", channel.name));
  }
  return out;
}

struct Standstill {
  double target = 0.0;            // in its unit
  double begin = 0.0, end = 0.0;  // s
};

std::vector<Standstill> standstills(const Samples& target, double last, double least) {
  std::vector<Standstill> out;
  for (std::size_t i = 0; i < target.time.size();) {
    std::size_t next = i + 1;
    while (next < target.time.size() && target.value[next] == target.value[i]) ++next;
    const double end = next < target.time.size() ? target.time[next] : last;
    if (end - target.time[i] >= least) out.push_back({target.value[i], target.time[i], end});
    i = next;
  }
  return out;
}

// Mean over the second half of a standstill, or the value that held there.
std::optional<double> position_at(const Samples& position, const Standstill& at) {
  const double begin = 0.5 * (at.begin + at.end);
  const auto first = std::lower_bound(position.time.begin(), position.time.end(), begin);
  const auto last = std::lower_bound(position.time.begin(), position.time.end(), at.end);
  const auto k = static_cast<std::size_t>(first - position.time.begin());
  if (first == last) return k > 0 ? std::optional(position.value[k - 1]) : std::nullopt;
  double sum = 0.0;
  for (auto i = first; i != last; ++i) {
    sum += position.value[static_cast<std::size_t>(i - position.time.begin())];
  }
  return sum / static_cast<double>(last - first);
}

class LogReader {
 public:
  LogReader(const Recording& recording, const LogSettings& settings)
      : recording_(recording), settings_(settings) {}

  PositioningFile read() {
    const Channel& target = channel_of(recording_, settings_.target, "--target");
    const Channel& position = channel_of(recording_, settings_.position, "--position");
    const double factor = factor_of(target.unit, target.name, true);
    const double own = factor_of(settings_.unit.empty() ? position.unit : settings_.unit,
                                 position.name, false, factor);
    const Samples targets = samples_of(recording_, target);
    const Samples positions = samples_of(recording_, position);
    const double last = std::max(targets.time.back(), positions.time.back());
    const auto all = standstills(targets, last, settings_.standstill);
    if (all.size() < 3) {
      throw InputError({recording_.file},
                       fmt::format("has {} standstills of {} that last {:g} s or more; change the "
                                   "time with --standstill",
                                   all.size(), target.name, settings_.standstill));
    }
    for (std::size_t i = 1; i < all.size(); ++i) {
      const auto found = position_at(positions, all[i]);
      if (!found) continue;
      TargetReading one;
      one.target = all[i].target * factor;
      one.direction = all[i].target > all[i - 1].target ? 1 : -1;
      one.deviation = *found * own - one.target;
      one.time = all[i].end;
      one.place = {recording_.file};
      readings_.push_back(one);
    }
    out_.remarks.push_back(
        fmt::format("{}: {} standstills of {}; the first one, {:g}, has no "
                    "direction and does not count",
                    recording_.file, all.size(), target.name, all.front().target));
    leave_out_turning_places(factor);
    take_away_zero();
    count_runs();
    out_.name = recording_.file;
    out_.test = arrange(readings_, angular_);
    for (std::string& one : outliers(readings_, angular_)) out_.remarks.push_back(std::move(one));
    return std::move(out_);
  }

 private:
  double factor_of(const std::string& unit, const std::string& name, bool is_target,
                   double otherwise = mm) {
    if (unit.empty()) {
      out_.remarks.push_back(fmt::format("{}: {} has no unit: {} is assumed", recording_.file, name,
                                         is_target ? "mm" : "that of the target"));
      return otherwise;
    }
    for (const config::Quantity& quantity : {config::kLength, config::kAngle}) {
      const auto found = config::unit_of_key("x_" + unit, quantity);
      if (!found) continue;
      const bool angular = quantity == config::kAngle;
      if (is_target) angular_ = angular;
      if (angular == angular_) return found->factor;
    }
    throw InputError({recording_.file},
                     fmt::format("{} is in \"{}\"; expected a length or an angle like the target; "
                                 "set the unit of the position with --unit",
                                 name, unit));
  }

  void leave_out_turning_places(double factor) {
    std::map<double, std::set<int>> ways;
    std::map<double, int> times;
    for (const TargetReading& one : readings_) {
      ways[one.target].insert(one.direction);
      ++times[one.target];
    }
    const bool both = std::any_of(ways.begin(), ways.end(),
                                  [](const auto& entry) { return entry.second.size() == 2; });
    if (!both) return;
    for (const auto& [target, directions] : ways) {
      if (directions.size() == 2) continue;
      out_.remarks.push_back(
          fmt::format("{}: target {:g} is approached in one direction only, {} times: treated as a "
                      "reversal point, not evaluated",
                      recording_.file, target / factor, times[target]));
      std::erase_if(readings_, [&, target = target](const TargetReading& one) {
        return one.target == target;
      });
    }
  }

  void take_away_zero() {
    double mean = 0.0;
    for (const TargetReading& one : readings_) mean += one.deviation;
    mean /= static_cast<double>(std::max<std::size_t>(readings_.size(), 1));
    const double largest = angular_ ? readings::kLargestAngle : readings::kLargestDeviation;
    if (std::abs(mean) > largest) {
      out_.remarks.push_back(fmt::format(
          "{}: position minus target is {:.6f} {} on average: the zero of the instrument, taken "
          "away",
          recording_.file, mean / (angular_ ? deg : mm), angular_ ? "deg" : "mm"));
      for (TargetReading& one : readings_) one.deviation -= mean;
    }
    for (const TargetReading& one : readings_) {
      if (std::abs(one.deviation) <= largest) continue;
      throw InputError({recording_.file},
                       fmt::format("deviates by {:.4g} {} at target {:g}; must be at most {:g} {}: "
                                   "check the unit of the position (--unit), its sign, and the "
                                   "channels",
                                   one.deviation / (angular_ ? deg : mm), angular_ ? "deg" : "mm",
                                   one.target / (angular_ ? deg : mm),
                                   largest / (angular_ ? deg : mm), angular_ ? "deg" : "mm"));
    }
  }

  void count_runs() {
    std::map<std::pair<double, int>, int> runs;
    for (TargetReading& one : readings_) one.run = runs[{one.target, one.direction}]++;
  }

  const Recording& recording_;
  const LogSettings& settings_;
  bool angular_ = false;
  std::vector<TargetReading> readings_;
  PositioningFile out_;
};

// "12", "3,5": indices in brackets, from 1
std::optional<std::vector<int>> indices_of(std::string_view text) {
  std::vector<int> out;
  for (const recordings::Field& field : recordings::split_fields(text, ',')) {
    const auto value = recordings::parse_number(field.text, '.');
    if (!value || !(*value >= 1.0 && *value <= 1e6) || *value != std::floor(*value)) return {};
    out.push_back(static_cast<int>(*value));
  }
  return out;
}

// Assignments, one a line; others than those that are known say nothing of the readings.
class ListReader {
 public:
  explicit ListReader(const std::string& file) : file_(file) {}

  PositioningFile read(std::string_view text) {
    for (const recordings::TextLine& line : recordings::text_lines(text)) read_line(line);
    PositioningFile out;
    out.name = file_;
    std::vector<TargetReading> all;
    for (Value& value : values_) {
      const auto target = targets_.find(value.index);
      if (target == targets_.end()) {
        faults_.push_back(
            {value.reading.place, fmt::format("is a reading at position {} without {}{}]",
                                              value.index, kTarget, value.index)});
        continue;
      }
      value.reading.target = target->second * unit_;
      value.reading.deviation = value.position * unit_ - value.reading.target;
      all.push_back(value.reading);
    }
    if (!faults_.empty()) throw InputError(std::move(faults_));
    sort(all);
    out.test = arrange(all, false);
    out.remarks = outliers(all, false);
    return out;
  }

 private:
  struct Value {
    int index = 0;
    double position = 0.0;
    TargetReading reading;
  };

  void fault(int line, std::string message) {
    faults_.push_back({{file_, line, 0}, std::move(message)});
  }

  void read_line(const recordings::TextLine& line) {
    if (line.text.starts_with(kUnit)) return set_unit(line);
    const bool is_target = line.text.starts_with(kTarget);
    const bool is_forward = line.text.starts_with(kForward);
    if (!is_target && !is_forward && !line.text.starts_with(kBackward)) return;
    const std::size_t open = line.text.find('['), close = line.text.find("]=");
    const auto indices = close == std::string_view::npos
                             ? std::nullopt
                             : indices_of(line.text.substr(open + 1, close - open - 1));
    const auto number = close == std::string_view::npos
                            ? std::nullopt
                            : recordings::parse_number(line.text.substr(close + 2), '.');
    if (!indices || indices->size() != (is_target ? 1U : 2U) || !number ||
        !std::isfinite(*number)) {
      fault(line.number, fmt::format("must be {} and a number",
                                     is_target ? "TGT_DATA[position]="
                                               : "REF_DATA_FWD[position,run]= or REF_DATA_BWD"));
      return;
    }
    if (is_target) {
      targets_[indices->front()] = *number;
      return;
    }
    Value value{.index = indices->front(), .position = *number, .reading = {}};
    value.reading.direction = is_forward ? 1 : -1;
    value.reading.run = indices->back() - 1;
    value.reading.place = {file_, line.number, 0};
    values_.push_back(value);
  }

  void set_unit(const recordings::TextLine& line) {
    const std::string unit(line.text.substr(kUnit.size()));
    const auto found = config::unit_of_key("x_" + unit, config::kLength);
    if (!found) return fault(line.number, fmt::format("UNIT = {}; must be a length", unit));
    unit_ = found->factor;
  }

  // In the order of the standard's cycle: each run all targets upwards, then all downwards.
  static void sort(std::vector<TargetReading>& all) {
    std::stable_sort(all.begin(), all.end(), [](const TargetReading& a, const TargetReading& b) {
      if (a.run != b.run) return a.run < b.run;
      if (a.direction != b.direction) return a.direction > b.direction;
      return a.direction > 0 ? a.target < b.target : a.target > b.target;
    });
  }

  const std::string& file_;
  double unit_ = mm;
  std::map<int, double> targets_;
  std::vector<Value> values_;
  std::vector<Fault> faults_;
};

}  // namespace

PositioningFile positioning_of(const Recording& recording, const LogSettings& settings) {
  return LogReader(recording, settings).read();
}

bool is_list_of_readings(std::string_view text) {
  return text.find(kForward) != std::string_view::npos ||
         text.find(kBackward) != std::string_view::npos;
}

PositioningFile parse_list_of_readings(std::string_view text, const std::string& file) {
  return ListReader(file).read(text);
}

}  // namespace servomill::sim::standards

#include "sim/limits/log_signals.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/config/quantity.h"
#include "sim/recordings/delimited_text.h"
#include "sim/recordings/uniform.h"

namespace servomill::sim::limits {
namespace {

using recordings::Channel;
using recordings::Recording;

std::string small(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return out;
}

// Names that channels of the commanded position of an axis have, the best first; "*": any
// beginning. LinuxCNC numbers joints in the order of the letters.
std::vector<std::string> names_of(char letter, int number) {
  const std::string low(1, static_cast<char>(letter - 'A' + 'a'));
  const char* kind = is_linear(*axis_of(letter)) ? "linear" : "rotary";
  std::vector<std::string> out = {low};
  for (const char* form :
       {"{} pos", "{}_pos", "pos_{}", "{} position", "position {}", "{}_cmd", "axis.{}.pos-cmd"}) {
    out.push_back(fmt::format(fmt::runtime(form), low));
  }
  for (const char* form : {"joint.{}.pos-cmd", "joint.{}.motor-pos-cmd", "joint.{}.joint-pos-cmd",
                           "joint.{}.pos-fb", "joint.{}.motor-pos-fb"}) {
    out.push_back(fmt::format(fmt::runtime(form), number));
  }
  for (const char* stage : {"cmd", "ref", "meas"}) {
    out.push_back(fmt::format("*/{}_{}_{}", stage, kind, low));
  }
  return out;
}

bool fits(const std::string& name, const std::string& pattern) {
  if (!pattern.starts_with('*')) return name == pattern;
  return name.ends_with(pattern.substr(1)) || name == pattern.substr(2);
}

// A channel as it is named, perhaps with its unit: "joint.0.vel-cmd [mm/s]".
struct NamedChannel {
  std::string name, unit;
};

NamedChannel named(std::string_view text) {
  const std::size_t open = text.rfind(" [");
  if (open == std::string_view::npos || !text.ends_with(']')) return {std::string(text), ""};
  return {std::string(text.substr(0, open)),
          std::string(text.substr(open + 2, text.size() - open - 3))};
}

class LogReader {
 public:
  LogReader(const Recording& recording, const JointLayout& layout, const LogRequest& request)
      : recording_(recording), layout_(layout), request_(request) {}

  LogSignals read() {
    if (request_.channels.empty()) {
      read_by_names();
    } else {
      for (const std::string& text : request_.channels) read_given(text);
    }
    return std::move(out_);
  }

 private:
  bool is_of_case(const Channel& channel) const {
    if (request_.case_name.empty()) return true;
    return channel.name.find("cases/" + request_.case_name + "/") != std::string::npos;
  }

  std::vector<std::string> all_names() const {
    std::vector<std::string> out;
    for (const Channel& channel : recording_.channels) out.push_back(channel.name);
    return out;
  }

  // A channel that may be a position: times that no base was made of are none.
  std::string example_name() const {
    for (const Channel& channel : recording_.channels) {
      const std::string name = small(channel.name);
      const bool is_time = name.starts_with("time") || name.starts_with("zeit") || name == "t";
      if (!is_time && !recordings::seconds_of(channel.unit)) return channel.name;
    }
    return "NAME";
  }

  const Channel* channel_by_names(const std::vector<std::string>& patterns) const {
    for (const std::string& pattern : patterns) {
      const Channel* found = nullptr;
      for (const Channel& channel : recording_.channels) {
        const std::string name(recordings::name_without_unit(channel.name));
        if (!fits(small(name), pattern) || !is_of_case(channel)) continue;
        if (found != nullptr) {
          throw InputError({recording_.file},
                           fmt::format("'{}' and '{}' both match; choose with --case or --channel",
                                       found->name, channel.name));
        }
        found = &channel;
      }
      if (found != nullptr) return found;
    }
    return nullptr;
  }

  void read_by_names() {
    std::string missing;
    int number = 0;
    for (int j = 0; j < kJoints; ++j) {
      if (!layout_.has(j)) continue;
      const Channel* channel = channel_by_names(names_of(layout_.letter_of(j), number++));
      if (channel != nullptr) {
        out_.notes.push_back(
            fmt::format("{} is channel '{}'", layout_.letter_of(j), channel->name));
        add(j, *channel, channel->unit);
      } else {
        missing += fmt::format("{}{}", missing.empty() ? "" : ", ", layout_.letter_of(j));
      }
    }
    if (out_.signals.empty()) {
      throw InputError({recording_.file},
                       fmt::format("no channel has the name of an axis ({}); assign them, such as "
                                   "--channel \"X={} [mm]\"",
                                   fmt::join(all_names(), ", "), example_name()));
    }
    if (!missing.empty()) {
      out_.notes.push_back(fmt::format("no channel is known as {}: not checked", missing));
    }
  }

  void read_given(const std::string& text) {
    const Place place{"--channel " + text};
    const auto axis = text.empty() ? std::nullopt : axis_of(text.front());
    if (!axis || text.size() < 3 || text[1] != '=') {
      throw InputError(place, "must be AXIS=CHANNEL, such as \"X=joint.0.pos-cmd [mm]\"");
    }
    const auto joint = layout_.joint_of(*axis);
    if (!joint) throw InputError(place, fmt::format("the machine has no axis {}", letter(*axis)));
    const NamedChannel given = named(std::string_view(text).substr(2));
    const Channel& channel = recordings::channel_of(recording_, given.name);
    add(*joint, channel, given.unit.empty() ? channel.unit : given.unit);
  }

  // Derivative of a position that a quantity is; -1: none.
  static int order_of(const config::Quantity& quantity, bool is_linear_joint) {
    const std::array linear = {config::kLength, config::kVelocity, config::kAcceleration};
    const std::array rotary = {config::kAngle, config::kAngularVelocity,
                               config::kAngularAcceleration};
    const auto& of = is_linear_joint ? linear : rotary;
    const auto found = std::find(of.begin(), of.end(), quantity);
    return found == of.end() ? -1 : static_cast<int>(found - of.begin());
  }

  void add(int joint, const Channel& channel, const std::string& unit) {
    const bool is_linear_joint = joint < kLinearJoints;
    AxisSignal out;
    out.joint = joint;
    out.channel = channel.name;
    out.unit = is_linear_joint ? mm : deg;
    out.unit_name = unit.empty() ? (is_linear_joint ? "mm" : "deg") : unit;
    if (unit.empty()) {
      out_.notes.push_back(fmt::format("channel '{}' has no unit: taken for a position in {}",
                                       channel.name, is_linear_joint ? "mm" : "deg"));
    } else {
      const config::ParsedUnit parsed = config::parse_unit(unit);
      const int order = parsed.unit ? order_of(parsed.unit->quantity, is_linear_joint) : -1;
      if (order < 0) {
        throw InputError(
            {recording_.file},
            fmt::format(
                "channel '{}': '{}' is not a unit of position, velocity or acceleration of {}",
                channel.name, unit, layout_.letter_of(joint)));
      }
      out.order = order;
      out.unit = parsed.unit->factor;
    }
    fill(out, channel);
    out_.signals.push_back(std::move(out));
  }

  void fill(AxisSignal& out, const Channel& channel) const {
    const recordings::Base& base = recording_.bases[channel.base];
    const bool is_numbered = base.unit == "1";
    if (base.unit == "Hz") throw InputError({recording_.file}, "is a spectrum, not a motion");
    if (is_numbered && !request_.period) {
      throw InputError({recording_.file},
                       "numbers its samples; set their period with --period, such as \"1 ms\"");
    }
    const Channel* lines = line_channel(channel);
    for (std::size_t k = 0; k < channel.samples.size(); ++k) {
      if (std::isnan(channel.samples[k])) continue;
      out.t.push_back(is_numbered ? base.values[k] * *request_.period : base.values[k]);
      out.x.push_back(channel.samples[k]);
      if (lines == nullptr) continue;
      const double line = lines->samples[k];
      out.line.push_back(std::isnan(line) ? 0 : static_cast<int>(std::lround(line)));
    }
  }

  // Channel of lines with the times of another channel.
  const Channel* line_channel(const Channel& channel) const {
    if (!request_.line_channel.empty()) {
      const Channel& given = recordings::channel_of(recording_, request_.line_channel);
      if (given.base == channel.base) return &given;
      throw InputError({"--line " + request_.line_channel},
                       fmt::format("has other times than channel '{}'", channel.name));
    }
    for (const Channel& one : recording_.channels) {
      const std::string name = small(one.name);
      const bool is_line = name == "line" || name.ends_with("/line") ||
                           name == "motion.program-line" || name == "program line";
      if (is_line && one.base == channel.base && is_of_case(one)) return &one;
    }
    return nullptr;
  }

  const Recording& recording_;
  const JointLayout& layout_;
  const LogRequest& request_;
  LogSignals out_;
};

}  // namespace

LogSignals log_signals(const Recording& recording, const JointLayout& layout,
                       const LogRequest& request) {
  return LogReader(recording, layout, request).read();
}

}  // namespace servomill::sim::limits

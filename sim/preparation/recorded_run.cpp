#include "sim/preparation/recorded_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/config/quantity.h"
#include "sim/recordings/read_recording.h"
#include "sim/recordings/uniform.h"

namespace servomill::sim::preparation {
namespace {

constexpr double kNear = 5 * um;        // of a reference from the planned path, as it is rounded
constexpr double kSamePath = 0.1 * mm;  // beyond it the recording is of another path
constexpr double kSlow = 1 * mm;        // m/s, of the plan: slower, time decides
constexpr double kRotaryRadius = 0.1;   // m, at which angles count
constexpr double kSameFeed = 0.05;      // share of the time of the feed motion
constexpr double kFarthestAhead = 2.0;  // s, of the plan: longer dwells may not differ

// SI of one unit of a channel.
double unit_of(const recordings::Channel& channel, const std::string& file, bool is_linear) {
  if (channel.unit.empty()) {
    throw InputError({file}, fmt::format("channel '{}' has no unit: name it '{} [{}]' in the file",
                                         channel.name, channel.name, is_linear ? "mm" : "deg"));
  }
  const config::ParsedUnit parsed = config::parse_unit(channel.unit);
  const config::Quantity wanted = config::parse_unit(is_linear ? "mm" : "deg").unit->quantity;
  if (parsed.unit && parsed.unit->quantity == wanted) return parsed.unit->factor;
  throw InputError({file}, fmt::format("channel '{}' is in {}; must be {}", channel.name,
                                       channel.unit, is_linear ? "a length" : "an angle"));
}

// One recording while its channels are taken.
class Channels {
 public:
  Channels(const recordings::Recording& recording, RecordedRun& out)
      : recording_(recording), out_(out) {}

  void take(const std::string& name, int joint, std::vector<Joints>& into) {
    const recordings::Channel& channel = recordings::channel_of(recording_, name);
    take_times(channel);
    const double unit = unit_of(channel, out_.file, joint < kLinearJoints);
    into.resize(out_.t.size(), Joints::Zero());
    for (std::size_t n = 0; n < out_.t.size(); ++n) {
      if (std::isnan(channel.samples[n])) {
        throw InputError({out_.file}, fmt::format("channel '{}' has no sample at {}", name,
                                                  recordings::at_text(base(), n)));
      }
      into[n][joint] = channel.samples[n] * unit;
    }
  }

 private:
  const recordings::Base& base() const { return recording_.bases[*base_]; }

  void take_times(const recordings::Channel& channel) {
    if (base_ && channel.base != *base_) {
      throw InputError({out_.file},
                       fmt::format("channel '{}' has other times than '{}'", channel.name, first_));
    }
    if (base_) return;
    base_ = channel.base;
    first_ = channel.name;
    if (base().unit != "s") {
      throw InputError({out_.file}, fmt::format("channel '{}' has no times", channel.name));
    }
    out_.t = base().values;
  }

  const recordings::Recording& recording_;
  RecordedRun& out_;
  std::optional<std::size_t> base_;
  std::string first_;
};

// Channels of a case of a result file, of all axes.
model::RecordedRunSpec with_channels(model::RecordedRunSpec spec, const JointLayout& layout) {
  if (spec.case_name.empty()) return spec;
  const bool sees_tip = spec.sees == model::SeenBy::tip;
  for (int j = 0; j < kJoints; ++j) {
    if (!layout.has(j)) continue;
    const char axis = layout.letter_of(j);
    const auto channel = [&](const char* signal) {
      return fmt::format("cases/{}/servo/{}_{}_{}", spec.case_name, signal,
                         j < kLinearJoints ? "linear" : "rotary", axis);
    };
    if (!sees_tip) spec.measured[axis] = channel("meas");
    spec.reference[axis] = channel("ref");
  }
  for (const char axis : {'X', 'Y', 'Z'}) {
    if (!sees_tip) break;
    spec.measured[axis] = fmt::format("cases/{}/servo/tool_position_true_{}", spec.case_name, axis);
  }
  return spec;
}

// Samples on a planned path.
class Follower {
 public:
  Follower(const RecordedRun& run, const PlannedInstants& path, const JointLayout& layout)
      : run_(run), path_(path), layout_(layout) {}

  std::vector<double> instants() {
    std::vector<double> out;
    for (std::size_t n = 0; n < run_.t.size(); ++n) {
      advance(n);
      out.push_back(static_cast<double>(at_));
    }
    refuse_other_path();
    refuse_partial();
    refuse_other_feed(out);
    return out;
  }

 private:
  double distance(std::size_t sample, std::size_t instant) const {
    double sum = 0.0;
    for (const int j : run_.joints) {
      const double off = run_.reference[sample][j] - path_.Q[instant][j];
      sum += std::pow(j < kLinearJoints ? off : kRotaryRadius * off, 2);
    }
    return std::sqrt(sum);
  }

  // The nearest instant of a range. Where the plan is slow, positions are rounded and time decides.
  std::size_t nearest(std::size_t sample, std::size_t from, std::size_t to,
                      std::size_t expected) const {
    const auto cost = [&](std::size_t k) {
      const auto off = static_cast<double>(k > expected ? k - expected : expected - k);
      return distance(sample, k) + kSlow * path_.h * off;
    };
    std::size_t best = from;
    double least = cost(from);
    for (std::size_t k = from + 1; k <= to; ++k) {
      const double now = cost(k);
      if (now >= least) continue;
      best = k;
      least = now;
    }
    return best;
  }

  void advance(std::size_t sample) {
    const std::size_t last = path_.Q.size() - 1;
    const double step = sample == 0 ? 0.0 : (run_.t[sample] - run_.t[sample - 1]) / path_.h;
    const std::size_t expected = std::min(last, at_ + static_cast<std::size_t>(step + 0.5));
    const std::size_t around = 5 + static_cast<std::size_t>(0.5 * step);
    const std::size_t from = std::max(at_, expected - std::min(expected, around));
    const std::size_t to = std::min(last, expected + around);
    std::size_t found = nearest(sample, std::min(from, to), to, expected);
    if (distance(sample, found) > kNear) found = farther(sample, found);
    note_distance(distance(sample, found), sample, found);
    if (sample > 0) note_passed(sample, found);
    at_ = found;
  }

  void note_distance(double off, std::size_t sample, std::size_t instant) {
    if (off <= worst_) return;
    worst_ = off;
    worst_sample_ = sample;
    worst_instant_ = instant;
  }

  // The plan between two samples must be near them.
  void note_passed(std::size_t sample, std::size_t found) {
    const double step = (run_.reference[sample] - run_.reference[sample - 1]).norm();
    for (std::size_t k = at_ + 1; k < found; ++k) {
      const double off = std::min(distance(sample, k), distance(sample - 1, k)) - step;
      note_distance(off, sample, k);
    }
  }

  // The first instant ahead at which the plan is near; if there is none, the nearest.
  std::size_t farther(std::size_t sample, std::size_t found) const {
    const auto ahead = static_cast<std::size_t>(kFarthestAhead / path_.h);
    const std::size_t to = std::min(path_.Q.size() - 1, found + ahead);
    std::size_t best = found;
    for (std::size_t k = at_; k <= to; ++k) {
      if (distance(sample, k) < distance(sample, best)) best = k;
      if (k > found && distance(sample, best) <= kNear) break;
    }
    return best;
  }

  [[noreturn]] void refuse(const std::string& why) const { throw InputError({run_.file}, why); }

  void refuse_other_path() const {
    if (worst_ <= kSamePath) return;
    int axis = run_.joints.front();
    const Joints off = run_.reference[worst_sample_] - path_.Q[worst_instant_];
    for (const int j : run_.joints) {
      if (std::abs(off[j]) > std::abs(off[axis])) axis = j;
    }
    const bool linear = axis < kLinearJoints;
    refuse(
        fmt::format("is not a recording of {}: at {:.4g} s its reference of {} is {:.4g} {} off "
                    "the planned path (line {})",
                    path_.program, run_.t[worst_sample_], layout_.letter_of(axis),
                    std::abs(off[axis]) / (linear ? mm : deg), linear ? "mm" : "deg",
                    path_.lines[worst_instant_]));
  }

  void refuse_partial() const {
    if (distance(0, 0) > kNear) refuse("begins after the program: it must begin at its start");
    if (at_ >= path_.end || distance(run_.t.size() - 1, path_.end) <= kNear) return;
    refuse(fmt::format("ends in line {} of {}: it must reach the end of the program",
                       path_.lines[at_], path_.program));
  }

  // An offset belongs to a feed: following errors grow with it.
  void refuse_other_feed(const std::vector<double>& instants) const {
    double recorded = 0.0, planned = 0.0;
    for (std::size_t n = 1; n < instants.size(); ++n) {
      const auto before = static_cast<std::size_t>(instants[n - 1]);
      const auto now = static_cast<std::size_t>(instants[n]);
      if (now == before || !path_.feeds[before] || !path_.feeds[now]) continue;
      recorded += run_.t[n] - run_.t[n - 1];
      planned += (instants[n] - instants[n - 1]) * path_.h;
    }
    if (std::abs(recorded - planned) <= kSameFeed * planned) return;
    refuse(
        fmt::format("was made at a different feed rate: its feed motion takes {:.4g} s, the "
                    "planned one {:.4g} s; set feed_share",
                    recorded, planned));
  }

  const RecordedRun& run_;
  const PlannedInstants& path_;
  const JointLayout& layout_;
  std::size_t at_ = 0;  // instant of the last sample
  double worst_ = 0.0;  // m, of a reference from the path
  std::size_t worst_sample_ = 0, worst_instant_ = 0;
};

}  // namespace

RecordedRun read_recorded_run(const model::RecordedRunSpec& spec, const JointLayout& layout) {
  RecordedRun out;
  out.file = spec.file;
  out.sees = spec.sees;
  if (spec.sees == model::SeenBy::part) {
    out.points = spec.case_name.empty()
                     ? readings::read_part_table(spec.file)
                     : readings::read_part_of_case(spec.file, spec.case_name, spec.probes);
    return out;
  }
  const model::RecordedRunSpec named = with_channels(spec, layout);
  const recordings::Recording recording = recordings::read_recording(spec.file);
  const bool sees_tip = spec.sees == model::SeenBy::tip;
  Channels channels(recording, out);
  std::size_t found = 0;
  for (int j = 0; j < kJoints; ++j) {
    const auto reference =
        layout.has(j) ? named.reference.find(layout.letter_of(j)) : named.reference.end();
    if (reference == named.reference.end()) continue;
    ++found;
    if (!sees_tip) channels.take(named.measured.at(reference->first), j, out.measured);
    channels.take(reference->second, j, out.reference);
    out.joints.push_back(j);
  }
  if (found < named.reference.size()) {
    throw InputError(spec.place, "names an axis that the machine lacks");
  }
  if (sees_tip) {
    for (const auto& [letter, channel] : named.measured) {
      out.seen.push_back(letter - 'X');
      channels.take(channel, out.seen.back(), out.measured);
    }
  }
  if (out.t.empty()) throw InputError({spec.file}, "has no samples");
  return out;
}

std::vector<double> instants_of(const RecordedRun& run, const PlannedInstants& path,
                                const JointLayout& layout) {
  return Follower(run, path, layout).instants();
}

std::vector<Joints> deviations_at(const std::vector<Joints>& deviation,
                                  const std::vector<double>& instants, std::size_t every,
                                  std::size_t rows) {
  std::vector<Joints> out;
  std::size_t next = 0;  // the first sample at or behind a row
  for (std::size_t row = 0; row < rows; ++row) {
    const auto instant = static_cast<double>(row * every);
    while (next < instants.size() && instants[next] < instant) ++next;
    if (next == 0 || next == instants.size()) {
      out.push_back(deviation[next == 0 ? 0 : instants.size() - 1]);
      continue;
    }
    const double before = instants[next - 1], behind = instants[next];
    const double share = (instant - before) / (behind - before);
    out.emplace_back(deviation[next - 1] + share * (deviation[next] - deviation[next - 1]));
  }
  return out;
}

}  // namespace servomill::sim::preparation

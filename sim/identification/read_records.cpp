#include "sim/identification/read_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "plant/vocabulary/axes.h"
#include "sim/config/quantity.h"
#include "sim/identification/channel_signal.h"
#include "sim/identification/possible_record.h"
#include "sim/input/scenario_document.h"
#include "sim/model/machine.h"
#include "sim/recordings/last_recording.h"
#include "sim/recordings/survey.h"
#include "sim/system/counted.h"

namespace servomill::sim::identification {
namespace {

constexpr std::array<std::string_view, 2> kUses = {"estimation", "validation"};
constexpr double kEqualPeriods = 1e-3;  // of a period: clocks of recorder and loop are one clock

// Roles of channels.
enum class Role : std::uint8_t {
  command,
  feedback,
  scale,
  force,
  motor_current,
  disturbance_force
};
constexpr std::array<std::string_view, 6> kRoles = {
    "command", "feedback", "scale", "force", "motor_current", "disturbance_force"};

config::Quantity quantity_of(Role role, bool linear) {
  switch (role) {
    case Role::command:
    case Role::feedback:
    case Role::scale:
      return linear ? config::kLength : config::kAngle;
    case Role::motor_current:
      return config::kCurrent;
    default:
      return linear ? config::kForce : config::kTorque;
  }
}

// Name as in "unit of length": without its article.
std::string quantity_noun(config::Quantity quantity) {
  const std::string name = config::name_of(quantity);
  return name.substr(name.find(' ') + 1);
}

// Factor of the unit: from the experiment, or from the file, or SI.
double unit_factor(config::Reader& table, const std::string& unit, config::Quantity quantity) {
  const config::ParsedUnit parsed = config::parse_unit(unit);
  if (!parsed.unit) {
    table.fault("unit", parsed.complaint);
    return 1.0;
  }
  if (!(parsed.unit->quantity == quantity)) {
    table.fault("unit", fmt::format("must be a unit of {}", quantity_noun(quantity)));
  }
  return parsed.unit->factor;
}

const recordings::Channel* find_channel(config::Reader& at, std::string_view key,
                                        const recordings::Recording& recording,
                                        const std::string& name) {
  std::vector<std::string_view> names;
  for (const recordings::Channel& channel : recording.channels) {
    if (channel.name == name) return &channel;
    names.push_back(channel.name);
  }
  // the reader has skipped it for a reason
  for (const std::string& note : recording.notes) {
    if (!note.starts_with(fmt::format("'{}' ", name))) continue;
    at.fault(key, fmt::format("is not a channel of {}: {}", recording.file, note));
    return nullptr;
  }
  at.fault(key, fmt::format("is not a channel of {}{}; it has {}", recording.file,
                            did_you_mean(name, names), fmt::join(names, ", ")));
  return nullptr;
}

double median_interval(const std::vector<double>& t) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < t.size(); ++k) steps.push_back(t[k] - t[k - 1]);
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                   steps.end());
  return steps[steps.size() / 2];
}

// Reads one item of the list `recording`.
class RecordReader {
 public:
  /// @param file  in place of the one that the table names, as the user names it; empty: none
  RecordReader(config::Reader& table, const model::MachineSettings& machine,
               const LoopSettings& loop, recordings::LastRecording& last_file, std::string file)
      : table_(table),
        machine_(machine),
        loop_(loop),
        last_file_(last_file),
        own_file_(std::move(file)) {}

  std::optional<AxisRecord> read() {
    const std::size_t before = table_.faults();  // of other recordings
    out_.place = table_.place("file");
    out_.record.name = table_.text("file");
    out_.record.validation = table_.choice_or("use", 0, kUses) == 1;
    out_.record.period = loop_.period;
    from_ = table_.real_or("from_s", -kForever, config::kTime);
    to_ = table_.real_or("to_s", kForever, config::kTime);
    std::string path = input::beside(out_.place, out_.record.name);
    if (!own_file_.empty()) {
      out_.record.name = path = own_file_;
      from_ = -kForever;  // parts are those of the file that the table names
      to_ = kForever;
    }
    longest_gap_ =
        table_.real_or("longest_gap_ms", 1.5 * loop_.period, config::kTime, {config::above(0.0)});
    const std::string unit = table_.text_or("time_unit", "");
    if (table_.faults() > before) return refused();
    recording_ = &last_file_.read(path, unit);
    read_roles();
    if (table_.faults() > before) return refused();
    sample();
    if (table_.faults() > before) return refused();
    if (const auto fault = impossible(out_.record)) table_.fault("file", *fault);
    return std::move(out_);
  }

 private:
  static constexpr double kForever = 1e300;

  std::nullopt_t refused() {
    table_.skip_rest();
    return std::nullopt;
  }

  void read_roles() {
    config::Reader axes = table_.table("axis");
    const std::vector<std::string> letters = axes.keys();
    if (letters.size() != 1) {
      table_.fault(
          "needs the channels of one axis, such as axis.X.feedback = \"NAME\"; list the "
          "file once for each of its axes");
      return;
    }
    out_.joint = -1;
    for (const int joint : machine_.joints()) {
      if (letters.front() == std::string(1, machine_.chain.layout.letter_of(joint))) {
        out_.joint = joint;
        out_.record.is_rotary = joint >= kLinearJoints;
      }
    }
    if (out_.joint < 0) {
      axes.raw(letters.front());
      axes.fault(letters.front(), "is not an axis of the machine");
      return;
    }
    config::Reader axis = axes.table(letters.front());
    for (std::size_t role = 0; role < kRoles.size(); ++role)
      read_role(axis, static_cast<Role>(role));
    const bool closed = loop_.kind != LoopKind::open;
    const auto needs = [&](Role role, std::string_view why) {
      const bool by_current = role == Role::force && use(Role::motor_current).present;
      if (use(role).present || by_current) return;
      axis.fault(fmt::format("lacks {}, which {}", kRoles[static_cast<std::size_t>(role)], why));
    };
    needs(Role::feedback, "is compared with the simulation");
    if (closed) needs(Role::command, "drives the loop");
    if (!closed) needs(Role::force, "drives the axis; or motor_current");
    if (use(Role::force).present && use(Role::motor_current).present) {
      axis.fault("has both force and motor_current; specify one of them");
    }
  }

  ChannelUse& use(Role role) { return uses_[static_cast<std::size_t>(role)]; }

  void read_role(config::Reader& axis, Role role) {
    const std::string_view key = kRoles[static_cast<std::size_t>(role)];
    if (!axis.has(key)) return;
    ChannelUse& one = use(role);
    one.present = true;
    const bool linear = out_.joint < kLinearJoints;
    const config::Quantity quantity = quantity_of(role, linear);
    if (axis.is(key, config::Value::Type::text)) {
      one.channel = axis.text(key);
      const recordings::Channel* channel = find_channel(axis, key, *recording_, one.channel);
      if (channel == nullptr || channel->unit.empty()) return;
      const config::ParsedUnit unit = config::parse_unit(channel->unit);
      if (unit.unit && unit.unit->quantity == quantity) {
        one.factor = unit.unit->factor;
      } else {
        axis.fault(key,
                   fmt::format("has the unit '{}' in the file, which is not a unit of {}; write "
                               "{{ channel = \"{}\", unit = \"...\", factor = ... }}",
                               channel->unit, quantity_noun(quantity), one.channel));
      }
      return;
    }
    config::Reader table = axis.table(key);
    one.channel = table.text("channel");
    const bool optional = table.boolean_or("optional", false);
    const recordings::Channel* channel =
        optional && channel_named(one.channel) == nullptr
            ? nullptr
            : find_channel(table, "channel", *recording_, one.channel);
    if (optional && channel == nullptr) {
      one.present = false;
      out_.notes.push_back(fmt::format("{}: has no channel '{}' for {}, which is optional",
                                       out_.record.name, one.channel, key));
    }
    const double factor = table.real_or("factor", 1.0, config::kNumber);
    if (factor == 0.0) table.fault("factor", "must not be 0");
    const std::string in_file = channel != nullptr ? channel->unit : "";
    const std::string unit = table.text_or("unit", table.has("factor") ? "" : in_file);
    one.factor = factor * (unit.empty() ? 1.0 : unit_factor(table, unit, quantity));
    one.delay = table.real_or("delay_ms", 0.0, config::kTime);
    one.offset = table.real_or("offset", 0.0, quantity);
  }

  // Brings the channels to the clock of the loop.
  void sample() {
    const recordings::Channel& feedback = *channel_of(Role::feedback);
    const recordings::Base& base = recording_->bases[feedback.base];
    const bool counted = base.unit == "1";  // sample numbers: one a period
    if (base.values.size() < 16) {
      table_.fault("file", "has fewer than 16 samples of the feedback");
      return;
    }
    if (!counted && base.unit != "s") {
      table_.fault("file", fmt::format("has the feedback as a function of {} in '{}', not of time",
                                       base.name, base.unit));
      return;
    }
    const double interval = counted ? loop_.period : median_interval(base.values);
    double stretch = counted ? loop_.period : 1.0;
    if (std::abs(interval / loop_.period - 1.0) < kEqualPeriods) {
      // two clocks that should be one: samples are counted
      if (!counted) stretch = loop_.period / interval;
      if (!counted && std::abs(stretch - 1.0) > 1e-9) {
        out_.notes.push_back(
            fmt::format("{}: sampled every {:.6g} ms, treated as the period of the loop, {:g} ms",
                        out_.record.name, interval * 1e3, loop_.period * 1e3));
      }
    } else if (interval > longest_gap_) {
      longest_gap_ = 1.5 * interval;
      out_.notes.push_back(
          fmt::format("{}: sampled every {:.6g} ms, interpolated to the {:g} ms of the loop",
                      out_.record.name, interval * 1e3, loop_.period * 1e3));
    }
    fill(stretch);
  }

  const recordings::Channel* channel_named(const std::string& name) const {
    for (const recordings::Channel& channel : recording_->channels) {
      if (channel.name == name) return &channel;
    }
    return nullptr;
  }
  const recordings::Channel* channel_of(Role role) {
    return use(role).present ? channel_named(use(role).channel) : nullptr;
  }

  void fill(double stretch) {
    std::array<std::optional<ChannelSignal>, kRoles.size()> signals;
    double first = from_, last = to_;
    for (std::size_t role = 0; role < kRoles.size(); ++role) {
      const recordings::Channel* channel = channel_of(static_cast<Role>(role));
      if (channel == nullptr) continue;
      signals[role].emplace(*channel, recording_->bases[channel->base], uses_[role], stretch);
      if (signals[role]->empty()) {
        table_.fault("file", fmt::format("has no sample of {}", channel->name));
        return;
      }
      first = std::max(first, signals[role]->first());
      last = std::min(last, signals[role]->last());
    }
    const double T = loop_.period;
    if (!(last - first >= 16.0 * T)) {
      table_.fault("file",
                   fmt::format("its channels have no common time range between {:g} and {:g} s",
                               first, last));
      return;
    }
    const auto count = static_cast<std::size_t>((last - first) / T + 1e-6) + 1;
    out_.record.start = first;
    const std::array<std::vector<double>*, kRoles.size()> into = {
        &out_.record.command, &out_.record.feedback, &out_.record.scale,
        &out_.record.force,   &out_.record.force,    &out_.record.disturbance};
    for (std::size_t role = 0; role < kRoles.size(); ++role) {
      if (!signals[role]) continue;
      const double to_force =
          static_cast<Role>(role) == Role::motor_current ? current_to_force() : 1.0;
      into[role]->resize(count);
      for (std::size_t k = 0; k < count; ++k) {
        (*into[role])[k] = to_force * (*signals[role])(first + T * static_cast<double>(k));
      }
    }
    if (use(Role::motor_current).present) out_.record.force_per_current = current_to_force();
    note_clipping();
    omit_gaps(*signals[static_cast<std::size_t>(Role::feedback)], first);
  }

  // A limit of the drive belongs to the loop, one of the recorder to nothing: either way the user
  // must know.
  void note_clipping() {
    for (const Role role : {Role::feedback, Role::force, Role::motor_current}) {
      const recordings::Channel* channel = channel_of(role);
      if (channel == nullptr) continue;
      const recordings::Base& base = recording_->bases[channel->base];
      for (const recordings::Clipping& one : recordings::clipping(*channel)) {
        out_.notes.push_back(
            fmt::format("{}: {} is clipped at {:g} in {} samples, first at {}; if the drive limits "
                        "it, set loop.force_limit; otherwise its value there is unknown",
                        out_.record.name, channel->name, one.level, one.samples,
                        recordings::at_text(base, one.first)));
      }
    }
  }

  double current_to_force() const {
    const plant::FeedDriveParams& drive = machine_.drives[static_cast<std::size_t>(out_.joint)];
    return drive.Kt / drive.r;
  }

  void omit_gaps(ChannelSignal& feedback, double first) {
    Record& r = out_.record;
    for (std::size_t k = 0; k < r.size(); ++k) {
      if (feedback.gap(first + r.period * static_cast<double>(k)) <= longest_gap_) continue;
      if (r.omitted.empty() || r.omitted.back().end != k) {
        r.omitted.push_back({k, k});
        out_.notes.push_back(fmt::format("{}: gap at {:.4g} s, excluded", r.name, r.time(k)));
      }
      r.omitted.back().end = k + 1;
    }
  }

  config::Reader& table_;
  const model::MachineSettings& machine_;
  const LoopSettings& loop_;
  recordings::LastRecording& last_file_;
  AxisRecord out_;
  std::string own_file_;
  double from_ = 0.0, to_ = 0.0, longest_gap_ = 0.0;
  const recordings::Recording* recording_ = nullptr;
  std::array<ChannelUse, kRoles.size()> uses_;
};

// "file.h5, axis X" where one file has the recordings of several axes.
void name_axes(std::vector<AxisRecord>& records, const model::MachineSettings& machine) {
  std::map<std::string, std::set<int>> axes;
  for (const AxisRecord& one : records) axes[one.record.name].insert(one.joint);
  for (AxisRecord& one : records) {
    if (axes[one.record.name].size() == 1) continue;
    one.record.name += fmt::format(", axis {}", machine.chain.layout.letter_of(one.joint));
  }
}

}  // namespace

std::vector<AxisRecord> read_records(config::Reader& root, const model::MachineSettings& machine,
                                     const LoopSettings& loop, const RecordingFiles& files) {
  std::vector<AxisRecord> out;
  std::vector<config::Reader> tables = root.tables("recording");
  recordings::LastRecording last_file;
  const auto read = [&](config::Reader& table, const std::string& file, bool validates) {
    auto record = RecordReader(table, machine, loop, last_file, file).read();
    if (!record) return;
    record->record.validation |= validates;
    out.push_back(std::move(*record));
  };
  if (files.estimation.size() > tables.size()) {
    throw InputError({"--recording"}, fmt::format("is given {} times; the experiment has {}",
                                                  files.estimation.size(),
                                                  system::counted(tables.size(), "recording")));
  }
  for (std::size_t k = 0; k < tables.size(); ++k) {
    read(tables[k], k < files.estimation.size() ? files.estimation[k] : "", false);
  }
  for (const std::string& file : files.validation) {
    if (!tables.empty()) read(tables.front(), file, true);
  }
  name_axes(out, machine);
  const bool any =
      std::any_of(out.begin(), out.end(), [](const AxisRecord& r) { return !r.record.validation; });
  if (root.faults() == 0 && !any)
    root.fault("all recordings are for validation; none is left for estimation");
  return out;
}

}  // namespace servomill::sim::identification

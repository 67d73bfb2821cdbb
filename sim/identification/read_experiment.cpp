#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "plant/vocabulary/units.h"
#include "sim/config/key_log.h"
#include "sim/config/written_number.h"
#include "sim/identification/experiment.h"
#include "sim/identification/parameter_space.h"
#include "sim/identification/read_records.h"
#include "sim/input/input_files.h"
#include "sim/input/read_servo.h"
#include "sim/input/scenario_document.h"

namespace servomill::sim::identification {
namespace {

constexpr std::array<std::string_view, 3> kLoops = {"open", "cascade", "nc"};
constexpr std::array<std::string_view, 2> kSpeedFeedbacks = {"scale", "motor"};

// The value that the document has at a dotted key, or nullptr.
const config::Value* value_at(const config::Value& root, const std::string& key) {
  const config::Value* at = &root;
  for (std::size_t begin = 0; at != nullptr && begin <= key.size();) {
    const std::size_t end = std::min(key.find('.', begin), key.size());
    if (at->type != config::Value::Type::table) return nullptr;
    at = at->find(key.substr(begin, end - begin));
    begin = end + 1;
  }
  return at;
}

config::WrittenNumber read_number(config::Reader& table, std::string_view key) {
  const config::Value* value = table.raw(key);
  const auto number = config::written_number(value->written);
  if (!number) table.fault(key, "must be a number, or a string such as \"20 N\"");
  return number.value_or(config::WrittenNumber{});
}

// A bound in the unit of the start.
double read_bound(config::Reader& table, std::string_view key, const std::string& unit,
                  double fallback) {
  if (!table.has(key)) return fallback;
  const config::WrittenNumber bound = read_number(table, key);
  if (bound.unit != unit) {
    table.fault(key, fmt::format("must be in the unit of the start, \"{}\"", unit));
  }
  return bound.value;
}

// The start as written, or the machine's own value.
config::WrittenNumber read_start(config::Reader& table, const Estimate& estimate,
                                 const config::Document& document) {
  if (table.has("start")) return read_number(table, "start");
  if (estimate.keys.empty()) return {};
  const config::Value* value = value_at(document.root(), document_key(estimate.keys.front()));
  if (value == nullptr) {
    table.fault(fmt::format("{} is not in the machine or the loop; add start = \"VALUE UNIT\"",
                            estimate.keys.front()));
    return {};
  }
  const auto number = config::written_number(value->written);
  if (!number) {
    table.fault(fmt::format("{} = {} is not a number", estimate.keys.front(), value->written));
  }
  return number.value_or(config::WrittenNumber{});
}

// Unit of a number without one: that of its key, or SI; empty for a ratio.
std::string unit_of_bare_number(const config::Document& document, const std::string& key) {
  const auto log = std::make_shared<config::KeyLog>();
  config::Document logged = document;
  logged.record_keys(log);
  model_of(logged, {}, {});
  const std::string whole = document_key(key);
  const std::size_t dot = whole.rfind('.');
  for (const config::KeyUse& use : log->uses()) {
    const bool is_it = use.type == config::KeyType::number && use.key == whole.substr(dot + 1) &&
                       use.table == config::without_items(whole.substr(0, dot));
    if (is_it && !use.unit.empty()) return use.unit;
  }
  return {};
}

// Estimates of which each recording has a value of its own become one for each.
std::vector<Estimate> with_own(const std::vector<Estimate>& estimates,
                               const std::vector<std::size_t>& own,
                               const std::vector<AxisRecord>& records) {
  std::vector<Estimate> out;
  for (std::size_t k = 0; k < estimates.size(); ++k) {
    if (std::find(own.begin(), own.end(), k) == own.end()) {
      out.push_back(estimates[k]);
      continue;
    }
    for (const AxisRecord& record : records) {
      if (record.record.validation) continue;
      out.push_back(estimates[k]);
      out.back().record = record.number;
    }
  }
  return out;
}

// The NC closes its loops on its own clock.
void check_nc_period(config::Reader& loop, const LoopSettings& settings,
                     const model::MachineSettings& machine) {
  if (settings.kind != LoopKind::nc) return;
  const double position = machine.nc.periods.seconds(machine.nc.periods.position);
  const double periods = settings.period / position;
  if (std::abs(periods - std::round(periods)) < 1e-6 && periods > 0.5) return;
  loop.fault("period_ms",
             fmt::format("must be an integer multiple of the position period of the NC, "
                         "{:g} ms",
                         position / ms));
}

// @param own  numbers of those of which each recording has its own
std::vector<Estimate> read_estimates(config::Reader& root, const config::Document& document,
                                     std::vector<std::size_t>& own) {
  std::vector<Estimate> estimates;
  for (config::Reader& table : root.tables("estimate")) {
    Estimate one;
    one.place = table.place("key");
    if (table.has("keys")) {
      one.keys = table.texts("keys");
    } else {
      one.keys = {table.text("key")};
    }
    const config::WrittenNumber start = read_start(table, one, document);
    one.start = start.value;
    one.unit = start.unit;
    one.lower = read_bound(table, "min", one.unit, one.lower);
    one.upper = read_bound(table, "max", one.unit, one.upper);
    if (one.unit.empty() && !one.keys.empty() && root.faults() == 0) {
      one.unit = unit_of_bare_number(document, one.keys.front());
    }
    if (table.boolean_or("own", false)) own.push_back(estimates.size());
    if (!(one.lower <= one.start && one.start <= one.upper)) {
      table.fault(fmt::format("start {:g} is not between min and max", one.start));
    }
    for (const Estimate& other : estimates) {
      for (const std::string& key : one.keys) {
        if (std::find(other.keys.begin(), other.keys.end(), key) != other.keys.end()) {
          table.fault(fmt::format("{} is estimated twice", key));
        }
      }
    }
    estimates.push_back(std::move(one));
  }
  return estimates;
}

// Disturbances of linear and of rotary axes.
void read_noise(config::Reader& root, NoiseSettings& linear, NoiseSettings& rotary) {
  if (!root.has("noise")) return;
  config::Reader table = root.table("noise");
  const double time = linear.force_time;
  linear.force_rms = table.real_or("force_rms", 0.0, config::kForce, {config::at_least(0.0)});
  linear.force_time = table.real_or("force_time_ms", time, config::kTime, {config::above(0.0)});
  linear.feedback_step =
      table.real_or("feedback_step_nm", 0.0, config::kLength, {config::at_least(0.0)});
  rotary.force_rms = table.real_or("torque_rms", 0.0, config::kTorque, {config::at_least(0.0)});
  rotary.force_time = table.real_or("torque_time_ms", time, config::kTime, {config::above(0.0)});
  rotary.feedback_step =
      table.real_or("feedback_step_urad", 0.0, config::kAngle, {config::at_least(0.0)});
  linear.seed = rotary.seed =
      static_cast<std::uint64_t>(table.integer_or("seed", 1, {config::at_least(0.0)}));
}

}  // namespace

LoopSettings read_loop(config::Reader& table) {
  LoopSettings loop;
  const std::size_t before = table.faults();
  loop.kind = static_cast<LoopKind>(table.choice_or("kind", 1, kLoops));
  if (table.faults() > before) {
    table.skip_rest();  // it decides about the other keys
    return loop;
  }
  loop.period = table.real("period_ms", config::kTime, {config::above(0.0)});
  loop.feedback_delay = table.real_or("feedback_delay_ms", 0.0, config::kTime);
  loop.feedback_offset = table.real_or("feedback_offset", 0.0, config::kLength);
  if (loop.kind == LoopKind::nc) return loop;
  loop.dead_time =
      table.real_or("dead_time_ms", 0.0, config::kTime,
                    {config::at_least(0.0), config::at_most(kLongestDeadTime * loop.period)});
  loop.position_feedback =
      static_cast<PositionSource>(table.choice_or("position_feedback", 0, kSpeedFeedbacks));
  if (loop.kind == LoopKind::open) {
    loop.force_offset = table.real_or("force_offset", 0.0, config::kForce);
    return loop;
  }
  const double infinite = std::numeric_limits<double>::infinity();
  loop.Kv = table.real("position_gain", config::kRate, {config::above(0.0)});
  loop.Kp = table.real("velocity_gain", config::kDamping, {config::above(0.0)});
  loop.Tn = table.real_or("velocity_reset_time_ms", infinite, config::kTime, {config::above(0.0)});
  loop.kvf = table.real_or("velocity_feed_forward", 0.0, config::kNumber);
  loop.kaf = table.real_or("acceleration_feed_forward", 0.0, config::kMass);
  loop.F_max = table.real_or("force_limit", infinite, config::kForce, {config::above(0.0)});
  loop.mean_of = static_cast<int>(table.integer_or(
      "feedback_mean_of", 1, {config::at_least(1.0), config::at_most(kMaxMeanOf)}));
  loop.speed_feedback =
      static_cast<SpeedFeedback>(table.choice_or("speed_feedback", 0, kSpeedFeedbacks));
  loop.filters = input::read_filters(table, loop.period);
  return loop;
}

Experiment read_experiment(const std::string& path, const RecordingFiles& recordings) {
  input::InputFiles files;
  const config::Document own = config::Document::from_file(path);
  if (const config::Value* overrides = own.root().find("machine_override")) {
    throw InputError(
        overrides->key_place,
        "machine_override is not allowed in an experiment, because identified values override a "
        "machine file; put these keys in a machine file with based_on = \"FILE\"");
  }
  const input::ScenarioDocument whole = input::with_machine(own, {}, files);
  Experiment out{.name = {},
                 .path = path,
                 .machine_path = {},
                 .document = whole.document,
                 .loop = {},
                 .records = {},
                 .estimates = {},
                 .noise = {},
                 .rotary_noise = {}};
  config::Reader root(out.document);
  out.name = root.text_or("name", std::filesystem::path(path).stem().string());
  const config::Value* machine = own.root().find("machine");
  if (machine != nullptr && machine->type == config::Value::Type::text) {
    out.machine_path = input::beside(machine->place, machine->text);
  }
  config::Reader loop = root.table("loop");
  out.loop = read_loop(loop);
  const model::MachineSettings settings = read_axes(root);
  if (root.faults() == 0) check_nc_period(loop, out.loop, settings);
  read_noise(root, out.noise, out.rotary_noise);
  out.compares_laws = root.boolean_or("compare_laws", false);
  std::vector<std::size_t> repeated;
  out.estimates = read_estimates(root, out.document, repeated);
  if (root.faults() == 0) out.records = read_records(root, settings, out.loop, recordings);
  if (root.faults() > 0) root.skip_rest();
  root.finish();
  for (std::size_t k = 0; k < out.records.size(); ++k) out.records[k].number = k;
  out.estimates = with_own(out.estimates, repeated, out.records);
  if (out.loop.kind == LoopKind::nc) add_controller(out.document, out.estimates);
  return out;
}

}  // namespace servomill::sim::identification

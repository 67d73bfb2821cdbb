#include "sim/sweep/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <iterator>
#include <set>
#include <string_view>
#include <utility>

#include "plant/vocabulary/interrupt.h"
#include "sim/config/document.h"
#include "sim/evaluation/comparison.h"
#include "sim/input/identified_values.h"
#include "sim/input/scenario_document.h"
#include "sim/model/design.h"
#include "sim/model/scenario.h"
#include "sim/preparation/estimate.h"
#include "sim/run/day_course.h"
#include "sim/run/run.h"
#include "sim/run/test_comparison.h"

namespace servomill::sim::sweep {
namespace {

constexpr std::uint64_t kProbes = 8;        // points tried before all are given up
constexpr std::uint64_t kMaxChecked = 256;  // points that `check` reads

// Values of these keys name files, which stand beside the scenario.
bool names_a_file(const std::string& key) {
  return key == "machine" || key == "program.file" || key == "part.stl";
}

std::string unquoted(const std::string& text) { return text.substr(1, text.size() - 2); }

// `count` points of `size`, the first and the last among them, in equal steps.
std::vector<std::uint64_t> spread(std::uint64_t size, std::uint64_t count) {
  std::vector<std::uint64_t> points;
  const std::uint64_t few = std::min(size, count);
  for (std::uint64_t i = 0; i < few; ++i) {
    points.push_back(few == 1 ? 0 : i * (size - 1) / (few - 1));
  }
  return points;
}

// The nearest of the names that the scenario has beside a key that it does not know.
std::string near_key(const std::string& resolved, const std::string& key) {
  const config::Document document = config::Document::from_text(resolved, "");
  const config::Value* table = &document.root();
  std::size_t begin = 0;
  for (std::size_t dot = key.find('.'); dot != std::string::npos && table != nullptr;
       dot = key.find('.', begin)) {
    table = table->find(key.substr(begin, dot - begin));
    begin = dot + 1;
  }
  if (table == nullptr || table->type != config::Value::Type::table) return {};
  std::vector<std::string_view> names;
  for (const config::Value& entry : table->children) names.push_back(entry.key);
  return did_you_mean(key.substr(begin), names);
}

// The part of KEY=VALUE before the '=', which may be quoted in it.
std::string key_of(const std::string& change) {
  char quote = 0;
  for (std::size_t i = 0; i < change.size(); ++i) {
    const char c = change[i];
    if (quote != 0) {
      if (c == quote) quote = 0;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '=') {
      return change.substr(0, i);
    }
  }
  return change;
}

// Tells if a value of the key is gone once `later` is set: keys have several spellings.
bool is_replaced(const config::Document& document, const std::string& key,
                 const std::string& later) {
  if (key != later && later == "machine") return false;  // its keys are set after the file is read
  const auto with = [&](const char* value) {
    config::Document changed = document;
    changed.set(key + "=" + value);
    changed.set(later + "=0");
    return changed.to_toml();
  };
  try {
    return with("1") == with("2");
  } catch (const InputError&) {
    return false;  // it is a table, in which the later key has its place
  }
}

// A value for a key that the sweep varies would never be used.
void refuse_swept(const std::vector<std::string>& changes, const model::Scenario& base) {
  if (changes.empty()) return;
  const config::Document document = config::Document::from_text(base.resolved, "");
  std::vector<Fault> faults;
  for (const std::string& change : changes) {
    for (const model::SweepKey& varied : base.sweep.keys) {
      if (!is_replaced(document, key_of(change), varied.key)) continue;
      faults.push_back({{"--set " + change},
                        fmt::format("the sweep varies {} ({}); this value would never be used",
                                    varied.key, to_string(varied.place))});
    }
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

// Samples are drawn about the machine that is run.
void refuse_other_machine(const model::Scenario& base) {
  const model::SweepDesign& design = base.sweep;
  const bool sweeps_machine = std::any_of(design.keys.begin(), design.keys.end(),
                                          [](const auto& one) { return one.key == "machine"; });
  if (sweeps_machine) return;
  const config::Document document = config::Document::from_text(base.resolved, "");
  for (const model::SweepKey& key : design.keys) {
    const auto* member = std::get_if<model::JointMember>(&key.values);
    if (member == nullptr) continue;
    const double mean = design.joint[member->group].mean[member->row];
    const std::string_view unit = member->unit.empty() ? input::kPlainNumber : member->unit;
    const config::Value* value = input::value_at(document.root(), key.key);
    if (value != nullptr && input::is_same_number(*value, key.key, mean, std::string(unit))) {
      continue;
    }
    throw InputError(
        key.place,
        fmt::format("sweep.samples: the mean of {} is {}{}{}, but the machine has {}; run "
                    "the identified machine: machine = \"FILE\"",
                    key.key, mean, member->unit.empty() ? "" : " ", member->unit,
                    value == nullptr ? "no such key" : config::inline_toml(*value)));
  }
}

// Without the value in it: the same fault at another point has another one.
std::string without(std::string message, const std::string& value) {
  const std::size_t at = message.find(value);
  return at == std::string::npos ? message : message.erase(at, value.size());
}

}  // namespace

Sweep::Sweep(std::string scenario_path, std::vector<std::string> changes,
             std::optional<std::string> text)
    : path_(std::move(scenario_path)),
      changes_(std::move(changes)),
      source_(path_, changes_, std::move(text)) {
  const auto base = std::make_shared<model::Scenario>(source_.at());
  base_ = base;
  if (base->sweep.empty()) {
    throw InputError({path_},
                     "has no [sweep] table; add one such as [sweep] "
                     "\"program.feed_override\" = [0.5, 1.0]");
  }
  refuse_swept(changes_, *base);
  refuse_other_machine(*base);
  base->swept_files = swept_files();
}

const model::SweepDesign& Sweep::design() const { return base_->sweep; }
const std::string& Sweep::name() const { return base_->name; }

std::vector<std::string> Sweep::left_out() const {
  std::vector<std::string> notes;
  if (base_->day && !run::is_day_asked_for(*base_)) notes.emplace_back(run::kDayLeftOut);
  if (base_->record.windows.limited()) notes.emplace_back(model::kWindowsLeftOut);
  return notes;
}

std::vector<evaluation::ComparisonRow> quantities_of(const model::Scenario& scenario) {
  std::vector<evaluation::ComparisonRow> rows = evaluation::compare(scenario.quantities, {});
  std::vector<evaluation::ComparisonRow> of_tests = run::rows_of_tests(scenario, {});
  std::move(of_tests.begin(), of_tests.end(), std::back_inserter(rows));
  return rows;
}

// The file that a value of a key names, seen from the folder in which the user is.
std::optional<std::string> Sweep::named_file(std::size_t key, const std::string& value) const {
  const model::SweepKey& one = design().keys[key];
  const bool quoted = value.size() >= 2 && (value.front() == '"' || value.front() == '\'');
  if (!quoted || !names_a_file(one.key)) return std::nullopt;
  return input::beside(one.place, unquoted(value));
}

std::string Sweep::assignment(std::size_t key, const std::string& value) const {
  const auto file = named_file(key, value);
  return design().keys[key].key + "=" + (file ? config::quoted_text(*file) : value);
}

std::string Sweep::swept_files() const {
  std::set<std::string> lines;
  const auto add = [&](const std::string& name, const std::string& file) {
    const auto checksum = source_.checksum(file);
    lines.insert(
        fmt::format("{} {}", checksum ? fmt::format("{:016x}", *checksum) : "unreadable", name));
  };
  for (std::size_t key = 0; key < design().keys.size(); ++key) {
    const auto* values = std::get_if<model::ValueTexts>(&design().keys[key].values);
    if (values == nullptr) continue;
    for (const std::string& value : *values) {
      const auto file = named_file(key, value);
      if (!file) continue;
      add(unquoted(value), *file);
      if (design().keys[key].key != "machine") continue;
      for (const std::string& base : source_.bases_of_machine(*file)) add(base, base);
    }
  }
  for (const model::SampleFile& file : design().sample_files) {
    add(file.name, input::beside(file.place, file.name));
  }
  return fmt::format("{}", fmt::join(lines, "\n"));
}

// The user wrote a list in the scenario, not --set: faults of its values stand there.
InputError Sweep::at_the_list(const InputError& error,
                              const std::vector<std::string>& values) const {
  std::vector<Fault> faults = error.faults();
  for (Fault& fault : faults) {
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (fault.place.file != "--set " + assignment(k, values[k])) continue;
      const model::SweepKey& key = design().keys[k];
      if (fault.message.ends_with("is not known")) {
        fault.message += near_key(base_->resolved, key.key);
      }
      fault.place = key.place;
      fault.message = fmt::format("sweep.\"{}\": {}", key.key, fault.message);
    }
  }
  return InputError(std::move(faults));
}

bool Sweep::draws_probing_noise() const {
  const auto& keys = design().keys;
  const bool is_swept =
      std::any_of(keys.begin(), keys.end(), [](const auto& one) { return one.key == "cmm.seed"; });
  return design().sampled_dimensions > 0 && base_->cmm.uncertainty > 0.0 && !is_swept;
}

model::Scenario Sweep::at(std::uint64_t point) const {
  const std::vector<std::string> values = design().point(point);
  std::vector<std::string> changes;
  for (std::size_t k = 0; k < values.size(); ++k) changes.push_back(assignment(k, values[k]));
  if (draws_probing_noise()) {
    const std::uint64_t sample = point % design().samples.count;
    changes.push_back(fmt::format("cmm.seed={}", base_->cmm.seed + sample));
  }
  try {
    model::Scenario scenario = source_.at(changes);
    scenario.record.windows = {};  // columns of a table have no note that they are not of all rows
    if (!run::is_day_asked_for(scenario)) scenario.day.reset();  // no point stores it
    return scenario;
  } catch (const InputError& error) {
    throw at_the_list(error, values);
  }
}

std::vector<evaluation::ComparisonRow> Sweep::quantities() const { return quantities_of(*base_); }

std::optional<preparation::RunEstimate> Sweep::refuse_hopeless() const {
  const auto probes = spread(design().size(), kProbes);
  std::vector<Fault> common;  // faults of all probes so far
  std::optional<InputError> first;
  for (const std::uint64_t point : probes) {
    const std::vector<std::string> values = design().point(point);
    try {
      const model::Scenario scenario = at(point);
      try {
        return run::check_scenario(scenario);
      } catch (const InputError& error) {
        throw at_the_list(error, values);
      }
    } catch (const InputError& error) {
      std::vector<Fault> faults = error.faults();
      for (Fault& fault : faults) {
        for (const std::string& value : values) fault.message = without(fault.message, value);
      }
      if (!first) {
        first = error;
        common = faults;
      }
      std::erase_if(common, [&](const Fault& one) {
        return std::none_of(faults.begin(), faults.end(), [&](const Fault& other) {
          return one.place == other.place && one.message == other.message;
        });
      });
    } catch (const Interrupted&) {
      throw;
    } catch (const std::exception&) {
      return std::nullopt;  // failed, not refused: its row will say why
    }
  }
  if (!common.empty() || probes.size() == design().size()) throw *first;
  return std::nullopt;
}

void Sweep::check() const {
  for (const std::uint64_t point : spread(design().size(), kMaxChecked)) {
    const model::Scenario scenario = at(point);
    try {
      run::check_scenario(scenario);
    } catch (const InputError& error) {
      throw at_the_list(error, design().point(point));
    }
  }
}

}  // namespace servomill::sim::sweep

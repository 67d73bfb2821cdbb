#include "sim/input/read_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "plant/vocabulary/units.h"
#include "sim/input/known_name.h"
#include "sim/input/read_cutting.h"
#include "sim/input/read_machine.h"
#include "sim/input/read_program.h"
#include "sim/input/read_strategy.h"
#include "sim/input/scenario_document.h"
#include "sim/model/run_settings.h"
#include "sim/model/scenario.h"
#include "strategies/entry.h"

namespace servomill::sim::input {
namespace {

constexpr std::array<std::string_view, 2> kServos = {"cascade", "ideal"};

const strategies::Entry* user_of_hardware(const model::CaseSpec& spec) {
  for (const model::StrategySpec& strategy : spec.strategies) {
    if (strategy.entry->uses_feedback_hardware) return strategy.entry;
  }
  return nullptr;
}

// The machine of a document, of which nothing else is read.
model::MachineSettings machine_in(const config::Document& document) {
  config::Reader root(document);
  for (const std::string& key : root.keys()) {
    if (key != "machine") root.raw(key);
  }
  config::Reader machine = root.table("machine");
  model::MachineSettings out = read_machine(machine);
  root.finish();
  return out;
}

bool same_clock(const model::MachineSettings& a, const model::MachineSettings& b) {
  return a.nc.periods == b.nc.periods && a.scale_delay == b.scale_delay;
}

bool same_axes(const model::MachineSettings& a, const model::MachineSettings& b) {
  return std::equal(a.chain.axes.begin(), a.chain.axes.end(), b.chain.axes.begin(),
                    b.chain.axes.end(), [](const auto& one, const auto& other) {
                      return one.axis == other.axis && one.side == other.side;
                    });
}

}  // namespace

CaseReader::CaseReader(std::vector<std::string> error_models, bool hardware_is_chosen,
                       model::Scenario& out)
    : error_models_(std::move(error_models)), hardware_is_chosen_(hardware_is_chosen), out_(out) {}

void CaseReader::read(config::Reader& table) {
  model::CaseSpec spec;
  const std::size_t before = table.faults();
  spec.name = table.text("name");
  if (table.faults() == before) check_name(table, spec.name);
  if (table.faults() > before) names_are_known_ = false;
  if (table.has("work_offset")) {
    config::Reader words = table.table("work_offset");
    spec.work_offset = read_offsets(words, out_.machine.chain.layout);
  }
  const bool says_hardware = table.has("feedback_hardware");
  spec.feedback_hardware = table.boolean_or("feedback_hardware", out_.hardware.connected);
  read_case_cutting(table, out_.cutting, spec);
  spec.servo = static_cast<model::ServoModel>(table.choice_or("servo", 0, kServos));
  check_recording(table, spec);
  if (table.has("machine_errors")) {
    spec.machine_errors = table.text("machine_errors");
    if (!spec.machine_errors->empty()) {
      must_be_known(table, "machine_errors", *spec.machine_errors, "error model", error_models_);
    }
  }
  for (config::Reader& strategy : table.tables_or_none("strategy")) {
    const config::Value* known = read_strategy(strategy, error_models_, spec);
    if (known != nullptr) known_[out_.cases.size()].emplace(spec.strategies.size() - 1, *known);
  }
  if (table.has("machine_override")) note_machine_override(table);
  give_hardware(table, says_hardware, spec);
  out_.cases.push_back(std::move(spec));
}

// The name becomes a group of the result file.
void CaseReader::check_name(config::Reader& table, const std::string& name) const {
  if (name.empty() || name == "." || name == "..") {
    table.fault("name", "must not be empty");
  } else if (name.find('/') != std::string::npos) {
    table.fault("name", "must not contain '/'");
  } else if (out_.find_case(name) != nullptr) {
    table.fault("name", "is already used by an earlier case");
  }
}

void CaseReader::check_recording(config::Reader& table, const model::CaseSpec& spec) const {
  if (spec.servo == model::ServoModel::ideal &&
      out_.record_period % out_.machine.nc.periods.position != 0) {
    table.fault(
        "servo",
        fmt::format("is recorded at the position-loop period: record.period_ms must be an integer "
                    "multiple of {:g} ms",
                    out_.machine.nc.periods.seconds(out_.machine.nc.periods.position) / ms));
  }
}

void CaseReader::give_hardware(config::Reader& table, bool says_hardware, model::CaseSpec& spec) {
  if (const strategies::Entry* user = user_of_hardware(spec)) {
    if (says_hardware && !spec.feedback_hardware) {
      table.fault("feedback_hardware",
                  fmt::format("must not be false: the case has the strategy {}", user->name));
    }
    spec.feedback_hardware = true;
  } else if (!says_hardware && !hardware_is_chosen_) {
    follows_others_.push_back(out_.cases.size());
  }
}

void CaseReader::connect_hardware() {
  const bool any =
      std::any_of(out_.cases.begin(), out_.cases.end(),
                  [](const model::CaseSpec& one) { return one.needs_feedback_hardware(); });
  for (const std::size_t index : follows_others_) out_.cases[index].feedback_hardware = any;
}

void CaseReader::note_machine_override(config::Reader& table) {
  const config::Value* override = table.raw("machine_override");
  if (override->type != config::Value::Type::table) {
    table.fault("machine_override", "must be a table");
    return;
  }
  if (override->find("structure") != nullptr) {
    table.fault("machine_override", "must not change the structure, which is common to all cases");
  }
  if (override->find("errors") != nullptr) {
    table.fault("machine_override", "must not change errors; error models are common to all cases");
  }
  overrides_.emplace(out_.cases.size(), *override);
}

void CaseReader::read_machines(const config::Document& scenario) {
  std::vector<Fault> faults;
  for (std::size_t index = 0; index < out_.cases.size(); ++index) {
    const auto override = overrides_.find(index);
    try {
      if (override != overrides_.end()) {
        config::Document document = scenario;
        document.merge(as_machine(override->second));
        read_machine_of(index, document);
        read_known_machines(index, document);
      } else {
        read_known_machines(index, scenario);
      }
      refuse_cold_machine(out_.cases[index]);
    } catch (const InputError& error) {
      faults.insert(faults.end(), error.faults().begin(), error.faults().end());
    }
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

// Without heat there is no temperature that a strategy could follow.
void CaseReader::refuse_cold_machine(const model::CaseSpec& one) const {
  for (const model::StrategySpec& strategy : one.strategies) {
    if (!strategy.entry->corrects_heat) continue;
    const bool is_cold = out_.machine_of(one).heat == nullptr;
    if (!is_cold && (!strategy.machine || strategy.machine->heat)) continue;
    throw InputError(strategy.place,
                     fmt::format("case {}: strategy {}: the machine {} has no [heat]", one.name,
                                 strategy.entry->name, is_cold ? "of the case" : "that it knows"));
  }
}

void CaseReader::read_machine_of(std::size_t index, const config::Document& with_override) {
  model::CaseSpec& one = out_.cases[index];
  one.machine = machine_in(with_override);
  if (!same_clock(*one.machine, out_.machine)) {
    throw InputError(overrides_.at(index).place,
                     fmt::format("case {}: machine_override changes the periods of the loops or "
                                 "nc.scale_delay_us, which are common to all cases",
                                 one.name));
  }
}

void CaseReader::read_known_machines(std::size_t index, const config::Document& of_case) {
  const auto known_machines = known_.find(index);
  if (known_machines == known_.end()) return;
  model::CaseSpec& one = out_.cases[index];
  for (const auto& [number, keys] : known_machines->second) {
    const bool is_whole = keys.find("structure") != nullptr;
    config::Document document = of_case;
    if (is_whole) document = config::Document::from_text("", of_case.name());
    document.merge(as_machine(keys));
    auto known = std::make_shared<const model::MachineSettings>(machine_in(document));
    model::StrategySpec& strategy = one.strategies[number];
    if (!same_axes(*known, out_.machine) || !same_clock(*known, out_.machine)) {
      throw InputError(keys.place,
                       fmt::format("case {}: strategy {}: machine is another one: its structure, "
                                   "the periods of its loops and nc.scale_delay_us must be those "
                                   "of the scenario's machine",
                                   one.name, strategy.entry->name));
    }
    strategy.machine = std::move(known);
  }
}

}  // namespace servomill::sim::input

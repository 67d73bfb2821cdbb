#include "sim/input/read_strategy.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/input/known_name.h"
#include "sim/input/read_recorded_runs.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "strategies/registry.h"

namespace servomill::sim::input {
namespace {

constexpr double kNoBound = 1e300;  // of a parameter's specification
constexpr std::array<std::string_view, 2> kActions = {"impose", "compensate"};

void read_model(config::Reader& table, std::span<const std::string> error_models,
                model::StrategySpec& strategy) {
  strategy.action = table.choice_or("action", 1, kActions) == 0 ? strategies::Action::impose
                                                                : strategies::Action::compensate;
  if (strategy.action == strategies::Action::impose && !strategy.entry->imposes) {
    table.fault("action",
                fmt::format("must be \"compensate\": the strategy {} cannot impose errors",
                            strategy.entry->name));
  }
  strategy.model = table.text("model");
  if (table.is("model", config::Value::Type::text)) {
    must_be_known(table, "model", strategy.model, "error model", error_models);
  }
}

// Tells if a text does not even begin like a number with its unit.
bool is_word(config::Reader& table, std::string_view key) {
  if (!table.is(key, config::Value::Type::text)) return false;
  const std::string text = table.text(key);
  return text.find_first_of("0123456789") == std::string::npos;
}

bool is_one_of(const std::string& word, const ParameterSpec& spec) {
  return std::find(spec.words.begin(), spec.words.end(), word) != spec.words.end();
}

// The word of a parameter that is given, or its default; false if that is none of its words.
bool read_word(config::Reader& table, const ParameterSpec& spec, Parameters& out) {
  const bool given = table.has(spec.name);
  if (given && !table.is(spec.name, config::Value::Type::text)) return false;
  const std::string word = given ? table.text(spec.name) : std::string(spec.default_text);
  if (!is_one_of(word, spec)) return false;
  out.set(spec.name, std::string_view(word));
  return true;
}

// A parameter that has no words but these.
void read_other_word(config::Reader& table, const ParameterSpec& spec, Parameters& out) {
  // numbers stand for words, too: iterations = 1
  if (table.has(spec.name) && table.is(spec.name, config::Value::Type::integer)) {
    const std::string word = std::to_string(table.integer(spec.name));
    if (is_one_of(word, spec)) {
      out.set(spec.name, std::string_view(word));
      return;
    }
  }
  if (table.has(spec.name) && table.is(spec.name, config::Value::Type::boolean)) {
    const std::string word = table.boolean(spec.name) ? "true" : "false";
    if (is_one_of(word, spec)) {
      out.set(spec.name, std::string_view(word));
      return;
    }
  }
  table.raw(spec.name);
  const std::string near = table.is(spec.name, config::Value::Type::text)
                               ? did_you_mean(table.text(spec.name), spec.words)
                               : std::string();
  table.fault(spec.name, fmt::format("must be one of {}{}", fmt::join(spec.words, ", "), near));
  out.set(spec.name, spec.words.front());
}

void read_number(config::Reader& table, const ParameterSpec& spec, Parameters& out) {
  const bool given = table.has(spec.name);
  const config::ParsedUnit unit = config::parse_unit(spec.unit);
  const double factor = unit.unit ? unit.unit->factor : 1.0;
  const config::Quantity quantity = unit.unit ? unit.unit->quantity : config::kNumber;
  const config::Rule least = config::at_least(spec.min * factor);
  const config::Rules rules = {least, config::at_most(spec.max * factor)};
  if (given && !spec.words.empty() && is_word(table, spec.name)) {
    const std::string word = table.text(spec.name);
    table.fault(spec.name, fmt::format("must be a number or {}{}", fmt::join(spec.words, ", "),
                                       did_you_mean(word, spec.words)));
    out.set(spec.name, 0.0);
  } else if (given || spec.default_text.empty()) {
    const double value = spec.max < kNoBound    ? table.real(spec.name, quantity, rules)
                         : spec.min > -kNoBound ? table.real(spec.name, quantity, {least})
                                                : table.real(spec.name, quantity);
    out.set(spec.name, value);
  } else {
    out.set(spec.name, std::stod(std::string(spec.default_text)) * factor);
  }
}

void read_parameter(config::Reader& table, const ParameterSpec& spec, Parameters& out) {
  if (read_word(table, spec, out)) return;
  if (spec.is_number) {
    read_number(table, spec, out);
  } else {
    read_other_word(table, spec, out);
  }
}

bool adds_start(const model::StrategySpec& one) {
  return one.entry->holds_error_at_reference != nullptr &&
         one.entry->holds_error_at_reference(one.parameters);
}

// Tells if an earlier strategy for the same model adds the value at the start already.
bool repeats_start(const model::StrategySpec& strategy,
                   const std::vector<model::StrategySpec>& earlier) {
  return adds_start(strategy) &&
         std::any_of(earlier.begin(), earlier.end(), [&](const model::StrategySpec& other) {
           return other.entry == strategy.entry && other.model == strategy.model &&
                  adds_start(other);
         });
}

}  // namespace

const config::Value* read_strategy(config::Reader& table, std::span<const std::string> error_models,
                                   model::CaseSpec& spec) {
  const auto names = strategies::names();
  const std::size_t before = table.faults();
  const std::size_t index = table.choice("type", names);
  if (table.faults() > before) {
    table.skip_rest();
    return nullptr;
  }
  model::StrategySpec strategy;
  strategy.entry = strategies::find(names[index]);
  strategy.place = table.place("type");
  if (strategy.entry->reads_errors) read_model(table, error_models, strategy);
  for (const ParameterSpec& parameter : strategy.entry->parameters) {
    if (table.has(parameter.name)) {
      strategy.key_places.emplace(parameter.name, table.place(parameter.name));
    }
    read_parameter(table, parameter, strategy.parameters);
  }
  if (!strategy.entry->recorded_instead.empty()) read_recorded_runs(table, strategy);
  if (strategy.entry->uses_feedback_hardware && spec.needs_feedback_hardware()) {
    table.fault("type",
                "a case has only one feedback hardware: this is the second strategy that uses it");
  }
  if (repeats_start(strategy, spec.strategies)) {
    table.fault(
        "type",
        fmt::format("a second {} strategy for this model applies the value at the start twice; use "
                    "base_axis = \"all\", or zero_at_reference = true for all but one",
                    strategy.entry->name));
  }
  const config::Value* machine = nullptr;
  const bool knows_machine = strategy.entry->knows_machine(strategy.parameters);
  if (table.has("machine") && !knows_machine && strategy.entry->reads_loops != nullptr) {
    table.raw("machine");
    table.fault(
        "machine",
        fmt::format("applies to the strategy {} only if its prediction uses the position loops",
                    strategy.entry->name));
  } else if (table.has("machine") && knows_machine) {
    machine = table.raw("machine");
  }
  if (machine != nullptr && machine->type != config::Value::Type::table) {
    table.fault("machine", "must be the name of a machine file, or a table of keys of the machine");
    machine = nullptr;
  }
  spec.strategies.push_back(std::move(strategy));
  return machine;
}

}  // namespace servomill::sim::input

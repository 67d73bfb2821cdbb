#include "sim/input/scenario_document.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "plant/vocabulary/user_file.h"
#include "sim/evaluation/quantity.h"
#include "sim/input/based_on.h"
#include "sim/input/drawn_errors.h"
#include "sim/input/machine_document.h"

namespace servomill::sim::input {
namespace {

namespace fs = std::filesystem;

constexpr DocumentKind kScenario = {"a scenario", "scenarios"};

// The cases of two documents: one of the same name takes the place of the other, a new one comes
// behind them.
config::Value merged_cases(config::Value cases, const config::Value& above) {
  const auto name_of = [](const config::Value& one) {
    const config::Value* name = one.find("name");
    return name == nullptr ? std::string() : name->text;
  };
  for (const config::Value& one : above.children) {
    const auto known =
        std::find_if(cases.children.begin(), cases.children.end(),
                     [&](const config::Value& other) { return name_of(other) == name_of(one); });
    if (known == cases.children.end()) {
      cases.children.push_back(one);
    } else {
      *known = one;
    }
  }
  return cases;
}

// A document merged with the one that it is based on: its own keys override, lists as a whole, but
// for the cases.
config::Document with_base(const std::string& path, InputFiles& files, int bases_left) {
  config::Document document = *files.document(path);
  config::Value above = document.root();
  const auto base = take_base(above, kScenario, bases_left);
  if (!base) return document;
  const config::Document below = with_base(*base, files, bases_left - 1);
  config::Document out = config::Document::from_text("", path);
  out.merge(below.root());
  const config::Value* cases = below.root().find("case");
  config::Value* more = above.find("case");
  constexpr auto kList = config::Value::Type::list;
  if (cases != nullptr && more != nullptr && cases->type == kList && more->type == kList) {
    *more = merged_cases(*cases, *more);
  }
  out.merge(above);
  return out;
}

// Faults of the machine without which no later message would make sense.
void refuse_machine(const config::Document& document) {
  const config::Value& root = document.root();
  const config::Value* machine = root.find("machine");
  if (machine == nullptr && root.find("structure") != nullptr) {
    throw InputError({document.name()},
                     "is a machine, not a scenario; use it in a scenario as machine = \"FILE\"");
  }
  if (machine == nullptr || machine->type == config::Value::Type::text ||
      machine->type == config::Value::Type::table) {
    return;
  }
  throw InputError(machine->place,
                   fmt::format("machine = {}; must be the name of a machine file, or a table",
                               config::inline_toml(*machine)));
}

// True if a quantity of the scenario takes the covariance of identified errors.
bool needs_covariance(const config::Document& document) {
  const config::Value* quantities = document.root().find("quantity");
  if (quantities == nullptr) return false;
  return std::any_of(
      quantities->children.begin(), quantities->children.end(), [](const config::Value& one) {
        const config::Value* name = one.find("name");
        const auto* entry = name == nullptr ? nullptr : evaluation::find_quantity(name->text);
        return entry != nullptr && entry->needs_covariance;
      });
}

// Machine files that strategies know, in place of their names.
void add_known_machines(config::Document& document, InputFiles& files) {
  const config::Value* found = document.root().find("case");
  if (found == nullptr || found->type != config::Value::Type::list) return;
  config::Value cases = *found;
  bool any = false;
  for (config::Value& one : cases.children) {
    config::Value* strategies = one.find("strategy");
    if (strategies == nullptr) continue;
    for (config::Value& strategy : strategies->children) {
      config::Value* machine = strategy.find("machine");
      if (machine == nullptr || machine->type != config::Value::Type::text) continue;
      const std::string path = beside(machine->place, machine->text);
      config::Value contents = machine_document(path, files, machine->place).document.root();
      contents.key = machine->key;
      contents.key_place = machine->key_place;
      contents.place = machine->place;
      *machine = std::move(contents);
      any = true;
    }
  }
  if (!any) return;
  config::Value root;
  root.place = cases.place;
  root.children.push_back(std::move(cases));
  document.merge(root);
}

}  // namespace

std::string beside(const Place& place, const std::string& path) {
  std::string file = place.file.starts_with("--set")
                         ? path
                         : (fs::path(place.file).parent_path() / path).lexically_normal().string();
  remember_input(file);
  return file;
}

bool is_outdated_copy(config::Reader& table, std::string_view name, std::string_view contents) {
  return table.place(name).file.starts_with("--set") &&
         !table.place(contents).file.starts_with("--set");
}

config::Value as_machine(config::Value table) {
  table.key = "machine";
  config::Value root;
  root.place = table.place;
  root.children.push_back(std::move(table));
  return root;
}

bool comes_before_machine(std::string_view change) {
  return change.starts_with("machine=") || change.starts_with("machine_override");
}

config::Document scenario_document(const std::string& path, InputFiles& files) {
  return with_base(path, files, kMaxBases);
}

ScenarioDocument with_machine(config::Document scenario, std::span<const std::string> changes,
                              InputFiles& files) {
  ScenarioDocument out{std::move(scenario), {}};
  config::Document& document = out.document;
  for (const std::string& change : changes) {
    if (comes_before_machine(change)) document.set(change);
  }
  refuse_machine(document);
  std::optional<IdentifiedValues> identified;
  const config::Value* machine = document.root().find("machine");
  if (machine != nullptr && machine->type == config::Value::Type::text) {
    const std::string path = beside(machine->place, machine->text);
    out.machine_text = *files.text(path, machine->place, "machine");
    MachineDocument read = machine_document(path, files, machine->place);
    document.merge(as_machine(read.document.root()));
    identified = std::move(read.identified);
  }
  if (const config::Value* overrides = document.root().find("machine_override")) {
    if (overrides->type != config::Value::Type::table) {
      throw InputError(overrides->place, fmt::format("machine_override = {}; must be a table",
                                                     config::inline_toml(*overrides)));
    }
    document.merge(as_machine(*overrides));
    // done: read again, the resolved document must not undo what later changes say
    document.set("machine_override={}");
  }
  add_drawn_errors(document, files);  // before changes of the copy
  for (const std::string& change : changes) {
    if (!comes_before_machine(change)) document.set(change);
  }
  add_drawn_errors(document, files);  // where --set asks for it
  add_known_machines(document, files);
  if (identified && needs_covariance(document)) {
    document.merge(
        config::Document::from_text("[machine.identified]\n" + table_lines(*identified), "")
            .root());
  }
  return out;
}

}  // namespace servomill::sim::input

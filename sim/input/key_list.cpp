#include "sim/input/key_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <regex>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"
#include "sim/input/identified_values.h"
#include "sim/input/input_files.h"
#include "sim/input/key_help.h"
#include "sim/input/key_specimens.h"
#include "sim/input/read_scenario.h"
#include "sim/input/scenario_document.h"
#include "sim/model/scenario.h"
#include "strategies/registry.h"

namespace servomill::sim::input {
namespace {

// All requests of the readers for one key.
struct Requests {
  std::string section, key;
  std::vector<config::KeyUse> uses;
};

// A component error over mm: listed with those.
constexpr std::string_view kLeadError = "machine.axis.X.screw.lead_error";
constexpr std::size_t kMaxWords = 8;  // of a choice that are printed

struct Renaming {
  std::regex pattern;
  std::string to;
};

// One name for sections and keys that any name, axis or error may have.
std::string common_name(std::string name) {
  static const std::array<Renaming, 10> kNames = {{
      {std::regex(R"(^machine\.errors)"), "errors"},
      {std::regex(R"(\baxis\.[XYZABC]\b)"), "axis.X"},
      {std::regex(R"(\binertial_deflection\.[XYZ][XYZABC]\b)"), "inertial_deflection.XX"},
      {std::regex(R"(\bheat\.(surroundings|body|source|sensor)\.\w+)"), "heat.$1.NAME"},
      {std::regex(R"(^machine\.heat\.(body|sensor)\.NAME\.errors_per_K)"), "errors.NAME"},
      {std::regex(R"(\bE[XYZ]0[XYZABC]\b)"), "EX0C"},
      {std::regex(R"(\bE[ABC]0[XYZABC]\b)"), "EC0Y"},
      {std::regex(R"(\bE[XYZABC][XYZABC]\b)"), "EXX"},
      {std::regex(R"(^errors\.OTHER)"), "errors.NAME"},
      {std::regex(R"(^sweep\.(?!samples|zip).+)"), "sweep.KEY"},
  }};
  for (const Renaming& one : kNames) name = std::regex_replace(name, one.pattern, one.to);
  return name;
}

std::string common_key(const std::string& section, const std::string& key) {
  if (section == "machine.axis") return "X";
  if (section == "machine.inertial_deflection") return "XX";
  if (section == "sweep" && key != "samples" && key != "zip") return "KEY";
  if (section == "sweep.zip") return "KEY";
  if (section == "errors" || section == "machine.heat.surroundings" ||
      section == "machine.heat.body" || section == "machine.heat.source" ||
      section == "machine.heat.sensor" || section.ends_with("conductance_W_per_K")) {
    return "NAME";
  }
  if (section == "program.subroutines") return "NAME";
  if (section == "program.parameters") return "#101";
  if (section.ends_with("work_offset") || section.ends_with("start") || section == "test.at" ||
      section == "test.from" || section == "test.to" || section == "day.place.at") {
    return key.ends_with("_mm") ? "X_mm" : "C_deg";
  }
  return common_name(key);
}

std::shared_ptr<config::KeyLog> requests_of_readers() {
  auto log = std::make_shared<config::KeyLog>();
  for (const std::string_view text : key_specimens()) {
    InputFiles files;
    config::Document document = config::Document::from_text(text, "specimen");
    document.record_keys(log);
    const std::string name(document.root().find("title")->text);
    read_document(with_machine(std::move(document), {}, files), name, files);
  }
  config::Document identified = config::Document::from_text(identified_specimen(), "specimen");
  identified.record_keys(log);
  config::Reader root(identified);
  config::Reader machine = root.table("machine");
  read_identified(machine);
  root.finish();
  return log;
}

bool is_parameter_of_strategy(std::string_view key) {
  const auto has_it = [key](const strategies::Entry& entry) {
    return std::any_of(entry.parameters.begin(), entry.parameters.end(),
                       [key](const ParameterSpec& one) { return one.name == key; });
  };
  return std::any_of(strategies::entries().begin(), strategies::entries().end(), has_it);
}

// Sections in the order in which they are read, tables themselves left out where they have keys.
std::vector<Requests> grouped() {
  const auto log = requests_of_readers();
  std::vector<Requests> out;
  for (const config::KeyUse& use : log->uses()) {
    const std::string section = common_name(use.table);
    const std::string key = common_key(section, use.key);
    if (section == "case.strategy" && is_parameter_of_strategy(key)) continue;
    if (section == kLeadError) continue;
    auto at = std::find_if(out.begin(), out.end(), [&](const Requests& one) {
      return one.section == section && one.key == key;
    });
    if (at == out.end()) {
      // keys of a section stay together
      const auto last = std::find_if(out.rbegin(), out.rend(),
                                     [&](const Requests& one) { return one.section == section; });
      at = out.insert(last == out.rend() ? out.end() : last.base(), {section, key, {}});
    }
    at->uses.push_back(use);
  }
  return out;
}

std::string quoted_words(const std::vector<std::string>& words) {
  return fmt::format("\"{}\"", fmt::join(words, "\" | \""));
}

std::string type_of(const config::KeyUse& use) {
  const std::string unit = use.unit.empty() ? "" : " in " + use.unit;
  switch (use.type) {
    case config::KeyType::asked:
      return "";
    case config::KeyType::number:
      return "number" + unit;
    case config::KeyType::integer:
      return "integer";
    case config::KeyType::boolean:
      return "true | false";
    case config::KeyType::text:
      return "string";
    case config::KeyType::choice:
      return use.words.size() > kMaxWords ? fmt::format("one of {} names", use.words.size())
                                          : quoted_words(use.words);
    case config::KeyType::numbers:
      return "list of numbers" + unit;
    case config::KeyType::texts:
      return "list of strings";
    case config::KeyType::rows:
      return "list of lists of numbers";
    case config::KeyType::table:
      return "table";
    case config::KeyType::tables:
      return "list of tables";
  }
  return "";
}

void append_new(std::string& list, const std::string& item, std::string_view separator) {
  const std::string bounded = fmt::format("{0}{1}{0}", separator, list);
  if (item.empty() || bounded.find(fmt::format("{0}{1}{0}", separator, item)) != std::string::npos)
    return;
  list += (list.empty() ? "" : std::string(separator)) + item;
}

// A key that a reader looks for before it requires it may be absent.
std::string presence_of(const std::vector<config::KeyUse>& uses) {
  bool asked = false, required = false, optional = false;
  std::vector<std::string> defaults;
  const bool is_text =
      uses.back().type == config::KeyType::choice || uses.back().type == config::KeyType::text;
  for (const config::KeyUse& use : uses) {
    if (use.type == config::KeyType::asked) asked = asked || !required;
    if (use.type == config::KeyType::asked) continue;
    required = required || (use.required && !asked);
    optional = optional || !use.required;
    if (!use.fallback || use.fallback->empty()) continue;
    const std::string text = is_text ? '"' + *use.fallback + '"' : *use.fallback;
    if (std::find(defaults.begin(), defaults.end(), text) == defaults.end())
      defaults.push_back(text);
  }
  if (required && optional) return "required in some cases";
  if (required) return "required";
  if (defaults.size() == 1) return "default " + defaults.front();
  return defaults.empty() ? "optional" : "default depends on other keys";
}

KeyEntry entry_of(const Requests& requests) {
  KeyEntry out{requests.section,
               requests.key,
               "",
               "",
               presence_of(requests.uses),
               help_of_key(requests.section, requests.key)};
  for (const config::KeyUse& use : requests.uses) {
    append_new(out.type, type_of(use), " | ");
    append_new(out.unit, use.unit, " | ");
    if (!use.range.empty() && !out.range.empty() && use.range != out.range) {
      out.range = "bounds depend on other keys";
    } else if (!use.range.empty()) {
      out.range = use.range;
    }
  }
  if (out.type.empty()) out.type = "any";
  return out;
}

// The keys of one strategy, from its own table.
void append_strategies(std::vector<KeyEntry>& out) {
  constexpr double kNoBound = 1e300;  // of a parameter's specification
  for (const strategies::Entry& entry : strategies::entries()) {
    for (const ParameterSpec& spec : entry.parameters) {
      std::string type, range;
      if (spec.is_number) {
        type = spec.unit.empty() ? "number" : "number in " + std::string(spec.unit);
        if (spec.min > -kNoBound) range = fmt::format(">= {:g}", spec.min);
        if (spec.max < kNoBound) append_new(range, fmt::format("<= {:g}", spec.max), " and ");
      }
      for (const std::string_view word : spec.words) {
        append_new(type, fmt::format("\"{}\"", word), " | ");
      }
      const std::string presence =
          spec.default_text.empty() ? "required" : "default " + std::string(spec.default_text);
      out.push_back({fmt::format("case.strategy.{}", entry.name), std::string(spec.name), type,
                     range, presence, spec.help, std::string(spec.unit)});
    }
  }
}

}  // namespace

std::vector<KeyEntry> list_keys() {
  std::vector<KeyEntry> out;
  for (const Requests& one : grouped()) out.push_back(entry_of(one));
  append_strategies(out);
  return out;
}

namespace {

// The keys of every axis are those of X: "machine.axis.Y.friction" as "machine.axis.X.friction".
std::string with_listed_axis(std::string section) {
  constexpr std::string_view kAxis = "axis.";
  for (std::size_t at = section.find(kAxis); at != section.npos; at = section.find(kAxis, at + 1)) {
    const std::size_t letter = at + kAxis.size();
    const bool is_alone =
        letter + 1 == section.size() || (letter + 1 < section.size() && section[letter + 1] == '.');
    if (is_alone && axis_of(section[letter])) section[letter] = 'X';
  }
  return section;
}

}  // namespace

std::vector<KeyEntry> keys_of(std::string_view of_section) {
  const std::string section = with_listed_axis(std::string(of_section));
  std::vector<KeyEntry> out;
  std::vector<std::string> names;
  for (KeyEntry& one : list_keys()) {
    const std::string name = one.section.empty() ? std::string(kTopSection) : one.section;
    if (names.empty() || names.back() != name) names.push_back(name);
    const bool below = name.starts_with(fmt::format("{}.", section));
    if (section.empty() || name == section || below) out.push_back(std::move(one));
  }
  if (!out.empty()) return out;
  const std::vector<std::string_view> views(names.begin(), names.end());
  throw InputError({"servomill list keys"},
                   fmt::format("no section '{}'{}", section, did_you_mean(section, views)));
}

}  // namespace servomill::sim::input

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <set>

#include "sim/input/key_list.h"
#include "sim/input/read_scenario.h"
#include "sim/input/scenario_name.h"
#include "sim/model/scenario.h"
#include "tools/servomill/command_pages.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

constexpr std::size_t kAboutWidth = 60;

std::string files() { return fmt::format("{}\n", kFiles); }

// Sections that are lists: --set counts their tables from 0.
constexpr std::array<std::string_view, 8> kLists = {
    "case", "case.strategy", "quantity", "probe", "program.tool", "test", "day.place", "day.phase"};

// Name of a section in --set; empty: it has a name of the user's, or is of one strategy only.
std::string set_name(const std::string& section) {
  std::string out;
  for (std::size_t begin = 0; begin < section.size();) {
    const std::size_t end = std::min(section.find('.', begin), section.size());
    const std::string part = section.substr(begin, end - begin);
    const std::string path = section.substr(0, end);
    if (part == "NAME" || part == "KEY" || part.starts_with("E") || part == "XX") return {};
    if (path.starts_with("case.strategy.") || path.starts_with("sweep")) return {};
    out += part;
    if (std::find(kLists.begin(), kLists.end(), path) != kLists.end()) out += "[0]";
    out += '.';
    begin = end + 1;
  }
  return out;
}

std::string keys() {
  std::string out;
  std::set<std::string> known;
  for (const sim::input::KeyEntry& one : sim::input::list_keys()) {
    const std::string section = one.section.empty() ? "" : set_name(one.section);
    if (!one.section.empty() && section.empty()) continue;
    if (one.key == "NAME" || one.key == "KEY" || one.key.starts_with("EXX")) continue;
    const std::string name = fmt::format("{}{}=", section, one.key);
    if (known.insert(name).second) out += candidate(name, one.help);
  }
  return out;
}

// Cases of the first word that is a scenario.
std::string cases(const std::vector<std::string>& line) {
  std::string out;
  for (const std::string& word : line) {
    if (word.starts_with("-")) continue;
    try {
      const std::string file = sim::input::scenario_file(word, sim::input::scenario_folders());
      for (const auto& one : sim::input::read_scenario(file, {}).cases) {
        out += candidate(one.name, "case");
      }
      return out;
    } catch (const std::exception&) {
      continue;  // another word, or a scenario with faults, which the command itself reports
    }
  }
  return out;
}

std::string scenarios() {
  std::string out;
  for (const std::string& folder : sim::input::scenario_folders()) {
    for (const std::string& name : sim::input::scenario_names(folder)) {
      out += candidate(name, "scenario");
    }
  }
  return out;
}

// The option that the word stands behind and that takes a value, or nullptr.
const po::option_description* option_before(const CommandTexts& texts,
                                            const std::vector<std::string>& line) {
  if (line.size() < 2) return nullptr;
  const std::string& word = line[line.size() - 2];
  for (const auto& option : texts.options.options()) {
    const std::string both = option->format_name();
    const bool is_short = word.size() == 2 && both.starts_with(word + " ");
    if ((is_short || word == "--" + option->long_name()) && !option->format_parameter().empty()) {
      return option.get();
    }
  }
  return nullptr;
}

}  // namespace

std::string candidate(std::string_view word, std::string_view about) {
  std::string text(about.substr(0, about.find('\n')));
  if (text.size() > kAboutWidth) {
    text = text.substr(0, text.rfind(' ', kAboutWidth)) + " ...";
  }
  return fmt::format("{}\t{}\n", word, text);
}

std::string candidates(const CommandTexts& texts, const std::vector<std::string>& line) {
  const std::string word = line.empty() ? "" : line.back();
  if (const po::option_description* option = option_before(texts, line)) {
    if (option->long_name() == "set") return keys();
    if (option->long_name() == "case") return cases({line.begin(), line.end() - 2});
    return files();
  }
  if (word.starts_with("-")) {
    std::string out;
    for (const auto& option : texts.options.options()) {
      out += candidate("--" + option->long_name(), option->description());
    }
    return out;
  }
  if (texts.command == "list") {
    std::string out;
    std::string_view rest = texts.words;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find('|'), rest.size());
      out += candidate(rest.substr(0, end), "");
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return out;
  }
  return texts.words.find("SCENARIO") == std::string::npos ? files() : scenarios() + files();
}

}  // namespace servomill::tools

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <iostream>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/user_file.h"
#include "sim/input/plugins.h"
#include "sim/input/scenario_name.h"
#include "sim/system/output_name.h"
#include "tools/servomill/command.h"
#include "tools/servomill/command_pages.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

// Message of boost, and the nearest option of ours.
std::string unknown_option(const po::unknown_option& error, const po::options_description& known) {
  std::string given = error.get_option_name();
  given.resize(std::min(given.find('='), given.size()));
  std::vector<std::string> names;
  for (const auto& option : known.options()) names.push_back("--" + option->long_name());
  const std::vector<std::string_view> views(names.begin(), names.end());
  return fmt::format("unknown option '{}'{}", given, did_you_mean(given, views));
}

}  // namespace

Options::Options(std::string_view command, std::string_view synopsis, std::string_view summary,
                 std::string_view words)
    : command_(command), synopsis_(synopsis), summary_(summary), words_(words) {
  description_.add_options()("help,h", "this text");
}

bool Options::parse(const Arguments& arguments) {
  if (print_other_form(arguments)) return false;
  const Place place{"servomill " + command_};
  po::options_description all = description_;
  all.add_options()("words", po::value<std::vector<std::string>>());
  po::positional_options_description positional;
  positional.add("words", words_.empty() ? 0 : -1);
  try {
    po::store(
        po::command_line_parser(arguments)
            .options(all)
            .positional(positional)
            .style(po::command_line_style::unix_style & ~po::command_line_style::allow_guessing)
            .run(),
        values_);
    po::notify(values_);
  } catch (const po::unknown_option& error) {
    throw InputError(place, unknown_option(error, description_));
  } catch (const po::too_many_positional_options_error&) {
    throw InputError(place, "accepts only options; see --help");
  } catch (const po::error& error) {
    throw InputError(place, error.what());
  }
  if (!has("help")) {
    find_named_files();
    remember_files();
    for (const std::string& one : words()) {
      if (one.empty())
        throw InputError(place, fmt::format("{} is an empty string; see --help", words_));
    }
    return true;
  }
  std::cout << fmt::format("Usage: servomill {} {}\n\n{}\n\n", command_, synopsis_, summary_)
            << description_;
  return false;
}

void Options::find_named_files() {
  const std::vector<std::string> folders = sim::input::scenario_folders();
  const bool all = words_.find("SCENARIO") != std::string::npos;
  if (has("words") && (all || command_ == "check")) {
    for (std::string& word : values_.at("words").as<std::vector<std::string>>()) {
      // a FILE may also be a program
      const bool may_be_scenario = all || std::filesystem::path(word).extension().empty();
      if (!word.empty() && may_be_scenario) word = sim::input::scenario_file(word, folders);
    }
  }
  if (!has("machine")) return;
  boost::any& value = values_.at("machine").value();
  if (auto* one = boost::any_cast<std::string>(&value)) {
    if (!one->empty()) *one = sim::input::machine_file(*one, folders);
  } else if (auto* several = boost::any_cast<std::vector<std::string>>(&value)) {
    for (std::string& file : *several) {
      if (!file.empty()) file = sim::input::machine_file(file, folders);
    }
  }
}

bool Options::print_other_form(const Arguments& arguments) const {
  if (arguments.empty()) return false;
  const CommandTexts texts{command_, synopsis_, summary_, words_, description_};
  const Arguments more(arguments.begin() + 1, arguments.end());
  if (arguments.front() == kManualPage) {
    fmt::print("{}", manual_page(texts, more.empty() ? "" : more.front()));
  } else if (arguments.front() == kComplete) {
    fmt::print("{}", candidates(texts, more));
  } else {
    return false;
  }
  return true;
}

// A word or a value that is a file's name is an input, unless results go there.
void Options::remember_files() const {
  constexpr std::array<std::string_view, 8> kOutputs = {
      "csv", "make-up", "output", "point-uncertainty", "record", "signals", "table", "touches"};
  for (const auto& [name, value] : values_) {
    if (std::find(kOutputs.begin(), kOutputs.end(), name) != kOutputs.end()) continue;
    if (const auto* text = boost::any_cast<std::string>(&value.value())) remember_input(*text);
    if (const auto* texts = boost::any_cast<std::vector<std::string>>(&value.value())) {
      for (const std::string& one : *texts) remember_input(one);
    }
  }
}

std::string Options::word() const {
  const auto all = words();
  if (all.size() == 1) return all.front();
  throw InputError({"servomill " + command_},
                   fmt::format("expected one {}, got {}; see --help", words_, all.size()));
}

void add_plugin_option(Options& options) {
  options.add()("plugin", po::value<std::vector<std::string>>()->value_name("FILE"),
                "loads a shared library with strategies of its own (strategies/README.md)");
}

void load_plugins(const Options& options) {
  for (const std::string& file : options.list("plugin")) sim::input::load_plugin(file);
}

unsigned thread_count(const Options& options) {
  constexpr int kMax = 1024;
  const int threads = options.get<int>("threads");
  if (threads >= 0 && threads <= kMax) return static_cast<unsigned>(threads);
  throw InputError({"--threads"}, fmt::format("{}; must be >= 0 and <= {}", threads, kMax));
}

std::string output_name(const Options& options, const std::string& scenario_name,
                        std::string_view suffix) {
  if (options.has("output")) return options.get<std::string>("output");
  return fmt::format("{}{}.h5", scenario_name, suffix);
}

void refuse_other_format(const std::string& out) {
  for (const std::string_view other : {".csv", ".json", ".mat", ".toml", ".txt", ".xlsx"}) {
    if (!out.ends_with(other)) continue;
    throw InputError({"--output"}, fmt::format("'{}' would contain HDF5; must end with .h5", out));
  }
}

std::string output_of(const Options& options, const char* name, const char* suffix) {
  if (!options.has(name)) return {};
  const auto out = options.get<std::string>(name);
  if (!out.ends_with(suffix)) {
    throw InputError({fmt::format("--{}", name)},
                     fmt::format("'{}' must end with {}", out, suffix));
  }
  return out;
}

void refuse_unwritable(const Options& options, const std::string& out) {
  if (out.empty()) return;
  sim::system::output_target(out, sim::system::existing_of(options.has("force")));
}

}  // namespace servomill::tools

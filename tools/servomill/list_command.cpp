#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/input/key_text.h"
#include "sim/input/listings.h"
#include "sim/input/scenario_name.h"
#include "sim/system/json.h"
#include "tools/servomill/command.h"

namespace servomill::tools {
namespace {

namespace fs = std::filesystem;

// A file by the name that commands take, with its title.
void print_file(const std::string& name, const std::string& file, bool as_json) {
  const std::string title = sim::input::title_of(file);
  if (as_json) {
    fmt::print("{}\n", sim::system::JsonObject().text("name", name).text("title", title).line());
  } else {
    fmt::print("{:<50} {}\n", name, title);
  }
}

void list_files(const std::string& folder, bool machines, bool as_json) {
  if (!fs::is_directory(folder)) {
    throw InputError({folder}, "is not a folder; set the scenario folder with --folder");
  }
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const bool is_machine = entry.path().parent_path().filename() == "machines";
    if (entry.path().extension() == ".toml" && is_machine == machines) {
      files.push_back(entry.path().string());
    }
  }
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) print_file(file, file, as_json);
}

// Lists the folder of the options, or the first one that there is.
void list_files_of(const Options& options, bool machines) {
  const std::vector<std::string> folders = sim::input::scenario_folders();
  const bool as_json = options.has("json");
  if (options.has("folder") || folders.empty()) {
    const bool has_folder = options.has("folder");
    list_files(has_folder ? options.get<std::string>("folder") : "scenarios", machines, as_json);
  } else if (machines) {
    list_files(folders.front(), machines, as_json);
  } else {
    for (const std::string& name : sim::input::scenario_names(folders.front())) {
      print_file(name, fmt::format("{}/{}.toml", folders.front(), name), as_json);
    }
  }
}

void list_keys_of(const Options& options) {
  const std::vector<std::string> words = options.words();
  if (words.size() > 2) {
    throw InputError({"servomill list keys"},
                     fmt::format("takes one section, got {}; see --help", words.size() - 1));
  }
  if (options.has("json") && options.has("markdown")) {
    throw InputError({"--json"}, "excludes --markdown");
  }
  const std::vector<sim::input::KeyEntry> keys =
      sim::input::keys_of(words.size() == 2 ? words[1] : "");
  fmt::print("{}", options.has("json")       ? sim::input::as_json(keys)
                   : options.has("markdown") ? sim::input::as_markdown(keys)
                                             : sim::input::as_text(keys));
}

}  // namespace

int list_command(const Arguments& arguments) {
  namespace po = boost::program_options;
  Options options(
      "list", "strategies|machines|scenarios|quantities|rules|keys [SECTION]",
      "Prints the strategies with their keys, the quantities that a comparison can hold, "
      "the rules by which programs are read beyond LinuxCNC's, the machines and scenarios of a "
      "folder, or every key of scenarios and machines: what it does, type, unit, range, default. "
      "SECTION is one such as program or machine.axis.X, with those below it; top has the keys "
      "outside "
      "of sections. Machine files leave out 'machine.'. Required keys are so where they apply.",
      "strategies|machines|scenarios|quantities|rules|keys");
  options.add()(
      "folder", po::value<std::string>()->value_name("DIR"),
      "folder of machines and scenarios, whose files are printed; default: scenarios in the "
      "current folder, or those that are installed");
  options.add()("json", "keys, machines, scenarios: prints one JSON object per line");
  options.add()("markdown", "keys: prints a page with one table a section");
  add_plugin_option(options);
  if (!options.parse(arguments)) return kDone;
  load_plugins(options);
  if (const auto words = options.words(); !words.empty() && words.front() == "keys") {
    list_keys_of(options);
    return kDone;
  }
  const std::string what = options.word();
  const bool is_of_files = what == "machines" || what == "scenarios";
  if (options.has("markdown")) throw InputError({"--markdown"}, "applies to 'keys' only");
  if (options.has("json") && !is_of_files) {
    throw InputError({"--json"}, "applies to 'keys', 'machines' and 'scenarios' only");
  }
  if (what == "strategies") {
    fmt::print("{}", sim::input::describe_strategies());
  } else if (what == "quantities") {
    fmt::print("{}", sim::input::describe_quantities());
  } else if (what == "rules") {
    fmt::print("{}", sim::input::describe_reader_rules());
  } else if (is_of_files) {
    list_files_of(options, what == "machines");
  } else {
    constexpr std::string_view kWhat[] = {"strategies", "machines", "scenarios",
                                          "quantities", "rules",    "keys"};
    throw InputError({"servomill list"},
                     fmt::format("cannot list '{}'{}", what, did_you_mean(what, kWhat)));
  }
  return kDone;
}

}  // namespace servomill::tools

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/input/key_text.h"
#include "sim/input/listings.h"
#include "sim/input/scenario_name.h"
#include "sim/system/json.h"
#include "tools/servomill/command.h"
#include "tools/servomill/json_list.h"

namespace servomill::tools {
namespace {

namespace fs = std::filesystem;

void print_list(const std::vector<std::string>& objects) {
  JsonList list;
  for (const std::string& one : objects) list.add(one);
  list.end();
}

// A file by the name that commands take, with its title.
void print_file(const std::string& name, const std::string& file, JsonList* list) {
  const std::string title = sim::input::title_of(file);
  if (list != nullptr) {
    list->add(sim::system::JsonObject().text("name", name).text_or_null("title", title).line());
  } else {
    fmt::print("{:<50} {}\n", name, title);
  }
}

void list_files(const std::string& folder, bool machines, JsonList* list,
                const std::string& why_no_folder) {
  if (!fs::is_directory(folder)) throw InputError({folder}, why_no_folder);
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const bool is_machine = entry.path().parent_path().filename() == "machines";
    if (entry.path().extension() == ".toml" && is_machine == machines) {
      files.push_back(entry.path().string());
    }
  }
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) print_file(file, file, list);
}

// Lists the folder of the options, or the first one that there is.
void list_files_of(const Options& options, bool machines, JsonList* list) {
  const std::vector<std::string> folders = sim::input::scenario_folders();
  if (options.has("folder") || folders.empty()) {
    const bool has_folder = options.has("folder");
    if (has_folder) {
      list_files(options.get<std::string>("folder"), machines, list, "is not a folder");
    } else {
      list_files("scenarios", machines, list,
                 "is no folder here, and no scenarios are installed; name their folder with "
                 "--folder");
    }
  } else if (machines) {
    list_files(folders.front(), machines, list, "is not a folder");
  } else {
    for (const std::string& name : sim::input::scenario_names(folders.front())) {
      print_file(name, fmt::format("{}/{}.toml", folders.front(), name), list);
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
  if (options.has("json")) {
    print_list(sim::input::keys_json(keys));
    return;
  }
  fmt::print("{}",
             options.has("markdown") ? sim::input::as_markdown(keys) : sim::input::as_text(keys));
}

}  // namespace

int list_command(const Arguments& arguments) {
  namespace po = boost::program_options;
  Options options(
      "list", "strategies|machines|scenarios|quantities|rules|keys [SECTION]",
      "Prints the strategies with their keys, the quantities available in a comparison, the rules "
      "for reading programs beyond those of LinuxCNC, the machines and scenarios of a folder, or "
      "every key of scenarios and machines: meaning, type, unit, range, default. SECTION, such as "
      "program or machine.axis.X, includes its subsections; top selects the keys outside of "
      "sections. Machine files omit 'machine.'. A required key is required wherever it applies.",
      "strategies|machines|scenarios|quantities|rules|keys");
  options.add()("folder", po::value<std::string>()->value_name("DIR"),
                "folder of the machines and scenarios to list; default: scenarios in the current "
                "folder, or the installed ones");
  options.add()("json", "prints a JSON list, one object per item");
  options.add()("markdown", "keys: prints a page with one table per section");
  add_plugin_option(options);
  if (!options.parse(arguments)) return kDone;
  load_plugins(options);
  if (const auto words = options.words(); !words.empty() && words.front() == "keys") {
    list_keys_of(options);
    return kDone;
  }
  const std::string what = options.word();
  if (options.has("markdown")) throw InputError({"--markdown"}, "applies to 'keys' only");
  const bool json = options.has("json");
  const auto print = [json](const std::vector<std::string>& objects, const std::string& text) {
    json ? print_list(objects) : fmt::print("{}", text);
  };
  namespace input = sim::input;
  if (what == "strategies") {
    print(input::strategies_json(), input::describe_strategies());
  } else if (what == "quantities") {
    print(input::quantities_json(), input::describe_quantities());
  } else if (what == "rules") {
    print(input::reader_rules_json(), input::describe_reader_rules());
  } else if (what == "machines" || what == "scenarios") {
    JsonList list;
    list_files_of(options, what == "machines", json ? &list : nullptr);
    if (json) list.end();
  } else {
    constexpr std::string_view kWhat[] = {"strategies", "machines", "scenarios",
                                          "quantities", "rules",    "keys"};
    throw InputError({"servomill list"},
                     fmt::format("cannot list '{}'; must be one of {}{}", what,
                                 fmt::join(kWhat, ", "), did_you_mean(what, kWhat)));
  }
  return kDone;
}

}  // namespace servomill::tools

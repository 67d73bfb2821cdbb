#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/input/catalogue.h"
#include "tools/servomill/command.h"

namespace servomill::tools {
namespace {

namespace fs = std::filesystem;

void list_files(const std::string& folder, bool machines) {
  if (!fs::is_directory(folder)) {
    throw InputError({folder}, "is not a folder; name that of the scenarios with --folder");
  }
  std::vector<std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const bool is_machine = entry.path().parent_path().filename() == "machines";
    if (entry.path().extension() == ".toml" && is_machine == machines) {
      files.push_back(entry.path().string());
    }
  }
  std::sort(files.begin(), files.end());
  for (const std::string& file : files) fmt::print("{:<50} {}\n", file, sim::title_of(file));
}

}  // namespace

int list_command(const Arguments& arguments) {
  namespace po = boost::program_options;
  Options options(
      "list", "strategies|machines|scenarios|quantities|rules",
      "Prints the strategies with their keys, the quantities that a comparison can hold, "
      "the rules by which programs are read beyond LinuxCNC's, or the machines and scenarios of a "
      "folder.",
      "strategies|machines|scenarios|quantities|rules");
  options.add()("folder", po::value<std::string>()->default_value("scenarios")->value_name("DIR"),
                "where machines and scenarios are looked for");
  if (!options.parse(arguments)) return kDone;
  const std::string what = options.word();
  if (what == "strategies") {
    fmt::print("{}", sim::describe_strategies());
  } else if (what == "quantities") {
    fmt::print("{}", sim::describe_quantities());
  } else if (what == "rules") {
    fmt::print("{}", sim::describe_reader_rules());
  } else if (what == "machines" || what == "scenarios") {
    list_files(options.get<std::string>("folder"), what == "machines");
  } else {
    constexpr std::string_view kWhat[] = {"strategies", "machines", "scenarios", "quantities",
                                          "rules"};
    throw InputError({"servomill list"},
                     fmt::format("cannot list '{}'{}", what, did_you_mean(what, kWhat)));
  }
  return kDone;
}

}  // namespace servomill::tools

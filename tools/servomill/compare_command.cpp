#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/model/scenario.h"
#include "sim/run/day_comparison.h"
#include "sim/run/day_course.h"
#include "sim/run/day_report.h"
#include "sim/run/store.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

int compare_command(const Arguments& arguments) {
  Options options(
      "compare", "OUT.h5...",
      "Evaluates the comparison of result files again from their recorded signals and prints it; "
      "days of machines with heat side by side: drift, temperatures, readings, parts.",
      "OUT.h5");
  options.add()("json", "prints one JSON object per line");
  add_plugin_option(options);
  if (!options.parse(arguments)) return kDone;
  load_plugins(options);
  if (options.words().empty()) {
    throw InputError({"servomill compare"}, "needs at least one OUT.h5; see --help");
  }
  std::vector<sim::run::NamedDay> days;
  for (const std::string& path : options.words()) {
    const sim::run::StoredRun run = sim::run::read_run(path);
    for (const sim::run::NamedDay& one : run.days) {
      if (options.has("json")) {
        fmt::print("{}\n", sim::run::day_json(one.name, *one.day));
        continue;
      }
      const std::string stem = std::filesystem::path(path).stem().string();
      days.push_back({options.words().size() > 1 ? stem + ":" + one.name : one.name, one.day});
    }
    const auto rows = sim::evaluation::compare(run.quantities, run.cases);
    if (options.has("json")) {
      for (const auto& row : rows) fmt::print("{}\n", sim::evaluation::to_json(row));
    } else {
      fmt::print("{}: {}\n\n{}\n", path, run.title,
                 rows.empty() && !run.days.empty() ? "" : sim::evaluation::format_table(rows));
    }
  }
  if (!days.empty()) fmt::print("{}", sim::run::days_side_by_side(days));
  return kDone;
}

}  // namespace servomill::tools

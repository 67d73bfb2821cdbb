#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/model/quantity_spec.h"
#include "sim/run/day_comparison.h"
#include "sim/run/day_course.h"
#include "sim/run/day_report.h"
#include "sim/run/stored_run.h"
#include "tools/servomill/command.h"
#include "tools/servomill/json_list.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {

int compare_command(const Arguments& arguments) {
  Options options(
      "compare", "OUT.h5...",
      "Evaluates the comparison of result files again from their recorded signals and prints it. "
      "Days of machines with heat are printed side by side: drift, temperatures, readings, parts.",
      "OUT.h5");
  options.add()("json", "prints a JSON list, one object per line of the comparison and per day");
  add_plugin_option(options);
  if (!options.parse(arguments)) return kDone;
  load_plugins(options);
  if (options.words().empty()) {
    throw InputError({"servomill compare"}, "needs at least one OUT.h5; see --help");
  }
  const bool json = options.has("json");
  JsonList list;
  ProgressLine line(options);
  Stage files("files", static_cast<double>(options.words().size()), Steps::unlike);
  std::vector<sim::run::NamedDay> days;
  for (const std::string& path : options.words()) {
    const sim::run::StoredRun run = sim::run::read_run(path);
    for (const sim::run::NamedDay& one : run.days) {
      if (json) {
        list.add(sim::run::day_json(one.name, *one.day));
        continue;
      }
      const std::string stem = std::filesystem::path(path).stem().string();
      days.push_back({options.words().size() > 1 ? stem + ":" + one.name : one.name, one.day});
    }
    const auto rows = sim::evaluation::compare(run.quantities, run.cases);
    files.advance();
    const auto hidden = line.hidden();
    if (json) {
      for (const auto& row : rows) list.add(sim::evaluation::to_json(row));
    } else {
      fmt::print("{}: {}\n\n{}\n", path, run.title,
                 rows.empty() && !run.days.empty() ? "" : sim::evaluation::format_table(rows));
    }
  }
  line.end();
  if (json) list.end();
  if (!days.empty()) fmt::print("{}", sim::run::days_side_by_side(days));
  return kDone;
}

}  // namespace servomill::tools

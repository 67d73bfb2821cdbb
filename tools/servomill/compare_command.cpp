#include <fmt/format.h>

#include "plant/vocabulary/input_error.h"
#include "sim/run/store.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

int compare_command(const Arguments& arguments) {
  Options options(
      "compare", "OUT.h5...",
      "Evaluates the comparison of result files again from their recorded signals and prints it.",
      "OUT.h5");
  options.add()("json", "prints one JSON object per line");
  add_plugin_option(options);
  if (!options.parse(arguments)) return kDone;
  load_plugins(options);
  if (options.words().empty()) {
    throw InputError({"servomill compare"}, "needs at least one OUT.h5; see --help");
  }
  for (const std::string& path : options.words()) {
    const sim::run::StoredRun run = sim::run::read_run(path);
    const auto rows = sim::evaluation::compare(run.quantities, run.cases);
    if (options.has("json")) {
      for (const auto& row : rows) fmt::print("{}\n", sim::evaluation::to_json(row));
    } else {
      fmt::print("{}: {}\n\n{}\n", path, run.title, sim::evaluation::format_table(rows));
    }
  }
  return kDone;
}

}  // namespace servomill::tools

#include <fmt/format.h>

#include <cstdio>
#include <optional>

#include "plant/vocabulary/input_error.h"
#include "sim/store.h"
#include "sim/sweep.h"
#include "tools/servomill/command.h"
#include "tools/servomill/interrupt.h"

namespace servomill::tools {

namespace po = boost::program_options;

int sweep_command(const Arguments& arguments) {
  Options options(
      "sweep", "SCENARIO.toml [-o OUT.h5] [--set KEY=VALUE]...",
      "Runs a scenario over the grid of its [sweep] table (one or two keys), prints the "
      "comparison at every point and writes the table to one HDF5 file.",
      "SCENARIO.toml");
  options.add()("output,o", po::value<std::string>()->value_name("OUT.h5"),
                "result file (default: name of the scenario with _sweep.h5, in this folder)");
  options.add()("set", po::value<std::vector<std::string>>()->value_name("KEY=VALUE"),
                "changes a key of the scenario at all points");
  options.add()("threads,j", po::value<int>()->default_value(0)->value_name("N"),
                "threads (default: one a core); results do not depend on it");
  options.add()("force,f", "replaces the result file if it exists");
  options.add()("json", "prints one JSON object a point and quantity");
  options.add()("quiet,q", "prints nothing but faults");
  if (!options.parse(arguments)) return kDone;

  const std::string path = options.word();
  const sim::Scenario scenario = sim::read_scenario(path, options.list("set"));
  const std::string out = output_name(options, scenario.name, "_sweep");
  sim::writable_name(out, options.has("force"));
  std::optional<sim::SweepStore> store;
  const auto& stop = stop_on_interrupt();
  ProgressBar bar(options.has("quiet"));
  sim::RunControl control;
  control.threads = thread_count(options);
  control.stop = &stop;
  control.progress = [&](double share) { bar.show(share); };
  control.prepared = [&] { store.emplace(out, options.has("force"), scenario); };
  bool finished = true;
  const auto point_done = [&](const sim::SweepPoint& point) {
    bar.clear();
    for (const std::string& why : point.stopped) fmt::print(stderr, "{}\n", why);
    finished &= point.stopped.empty();
    if (options.has("quiet")) return;
    bar.clear();
    std::string where;
    for (std::size_t k = 0; k < point.values.size(); ++k) {
      where += fmt::format("{}{} = {}", k == 0 ? "" : ", ", scenario.sweep[k].key, point.values[k]);
    }
    if (options.has("json")) {
      for (const auto& row : point.rows) {
        fmt::print("{{\"point\": \"{}\", \"row\": {}}}\n", sim::json_escaped(where),
                   sim::to_json(row));
      }
    } else {
      fmt::print("{}\n\n{}\n", where, sim::format_table(point.rows));
    }
    std::fflush(stdout);  // a point is told when it is known, to a pipe, too
  };
  const auto points = sim::run_sweep(path, options.list("set"), control, point_done);
  bar.clear();
  store->write(points);
  if (points.size() < sim::grid_of(scenario).size()) {
    fmt::print(stderr, "interrupted; kept in {}: {} complete points of {}\n", store->partial_path(),
               points.size(), sim::grid_of(scenario).size());
    return kInterrupted;
  }
  store->commit();
  if (!options.has("quiet") && !options.has("json")) fmt::print("written to {}\n", out);
  return finished ? kDone : kMachineStopped;
}

}  // namespace servomill::tools

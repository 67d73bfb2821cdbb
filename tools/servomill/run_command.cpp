#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "plant/vocabulary/interrupt.h"
#include "sim/input/plugins.h"
#include "sim/input/read_scenario.h"
#include "sim/model/scenario_parts.h"
#include "sim/preparation/estimate.h"
#include "sim/run/run.h"
#include "sim/run/store.h"
#include "sim/system/system_error.h"
#include "tools/servomill/command.h"
#include "tools/servomill/interrupt.h"
#include "tools/servomill/kept_cases.h"
#include "tools/servomill/progress_line.h"
#include "tools/servomill/run_reports.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

void add_run_options(Options& options) {
  options.add()("output,o", po::value<std::string>()->value_name("OUT.h5"),
                "result file (default: name of the scenario with .h5, in this folder)");
  options.add()("set", po::value<std::vector<std::string>>()->value_name("KEY=VALUE"),
                "changes a key of the scenario, such as program.feed_override=0.5, "
                "case[2].strategy[0].extrapolation_time_ms=auto or machine.nc.Kv=\"4 m/min/mm\"");
  options.add()("threads,j", po::value<int>()->default_value(0)->value_name("N"),
                "threads (default: one per core); results do not depend on it");
  options.add()("force,f", "replaces the result file if it exists");
  options.add()("touches", po::value<std::string>()->value_name("FOLDER"),
                "writes the positions latched by probing moves (G38.2 ...) to FOLDER/CASE.csv, as "
                "readings of kind touch");
  options.add()("readings", po::value<std::string>()->value_name("FOLDER"),
                "writes the readings of every [[test]] to FOLDER/CASE/TEST.csv (diagonals: "
                "TEST/PPP.csv, ...), as `servomill evaluate` reads them");
  options.add()("json", "prints a JSON list, one object per line of the comparison, test and day");
  options.add()("quiet,q", "prints only warnings and faults");
  add_plugin_option(options);
  options.add()("isolate",
                "simulates each case with a plug-in in a separate process: a plug-in that crashes, "
                "calls exit() or does not return within 10 s ends its case, not the command");
}

// Prints what a long run takes: before its trial runs, which take time, too, or else before it.
void print_estimate_once(bool& is_printed, const sim::preparation::RunEstimate& takes,
                         ProgressLine& line) {
  if (std::exchange(is_printed, true)) return;
  const auto hidden = line.hidden();
  if (sim::preparation::is_worth_telling(takes))
    fmt::print(stderr, "estimate: {}\n", sim::preparation::to_string(takes));
  if (takes.is_thinned) fmt::print(stderr, "{}\n", sim::preparation::thinning_message(takes));
}

// @param kept  on the complete cases; or empty
void print_failure(const sim::system::SystemError& error, const std::string& kept) {
  fmt::print(stderr, "{}\n", error.what());
  if (!kept.empty()) fmt::print(stderr, "{}\n", kept);
}

}  // namespace

int run_command(const Arguments& arguments) {
  Options options("run", "SCENARIO.toml [-o OUT.h5] [--set KEY=VALUE]...",
                  "Runs every case of a scenario, prints the comparison and writes all signals to "
                  "one HDF5 file. A long run first reports its number of rows, file size, memory "
                  "and time. If record.period_ms is not given and the signals exceed "
                  "record.max_size_GB, the rows are thinned.",
                  "SCENARIO.toml");
  add_run_options(options);
  if (!options.parse(arguments)) return kDone;
  load_plugins(options);
  if (options.has("isolate")) sim::input::isolate_plugins();

  ProgressLine line(options);
  const auto read = sim::input::shared_scenario(options.word(), options.list("set"));
  const sim::model::Scenario& scenario = *read;
  const std::string path = sim::run::writable_name(
      output_name(options, sim::model::name_of(scenario), ""), options.has("force"));
  refuse_other_format(path);
  const auto& stop = stop_on_interrupt();
  std::optional<sim::run::RunStore> store;
  sim::run::RunControl control;
  control.threads = thread_count(options);
  control.stop = &stop;
  control.scratch_folder = std::filesystem::absolute(path).parent_path().string();
  control.stores_signals = true;
  KeptCases kept(sim::model::case_names(scenario));
  const KeptWhenInterrupted when_interrupted([&kept] { return kept.said(); });
  control.case_done = [&](const sim::run::CaseOutput& one) {
    store->add(one);
    kept.add(one);
  };
  bool is_printed = false;
  control.trials_come = [&](const auto& takes) { print_estimate_once(is_printed, takes, line); };
  control.prepared = [&](const sim::preparation::RunEstimate& takes) {
    print_estimate_once(is_printed, takes, line);
    sim::preparation::refuse_full_disk(scenario, takes, control.scratch_folder);
    store.emplace(path, options.has("force"), scenario, control.threads);
    kept.in(store->partial_path());
  };
  std::shared_ptr<const sim::run::RunOutput> output;
  try {
    output = sim::run::shared_run(scenario, control);
    line.end();
    if (!kept.all_complete()) {
      print_interrupted(kept.said());
      return kInterrupted;
    }
    store->commit(sim::run::comparison_of(*output));
  } catch (const sim::system::SystemError& error) {
    line.end();
    print_failure(error, kept.said());
    return kSystemFailed;
  } catch (const Interrupted&) {
    line.end();
    print_interrupted(kept.said());
    return kInterrupted;
  }

  return print_output(*output, options, scenario, path);
}

}  // namespace servomill::tools

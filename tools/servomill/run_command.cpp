#include <fmt/format.h>

#include <filesystem>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "sim/input/plugins.h"
#include "sim/input/read_scenario.h"
#include "sim/preparation/estimate.h"
#include "sim/run/run.h"
#include "sim/run/store.h"
#include "sim/run/touch_record.h"
#include "sim/system/system_error.h"
#include "sim/system/write_file.h"
#include "tools/servomill/command.h"
#include "tools/servomill/interrupt.h"
#include "tools/servomill/json_list.h"
#include "tools/servomill/progress_line.h"
#include "tools/servomill/run_reports.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

// Notes on what the NC corrected or could not do as programmed, once for all cases.
void print_notes(const sim::run::RunOutput& output) {
  std::set<std::string> said;
  for (const sim::run::CaseOutput& one : output.cases) {
    for (const std::string& note : one.notes) {
      if (said.insert(note).second) fmt::print(stderr, "{}\n", note);
    }
  }
}

void print_outcomes(const sim::run::RunOutput& output) {
  for (const sim::run::CaseOutput& one : output.cases) {
    const sim::engine::CaseResult& result = one.result;
    if (result.outcome.finished) {
      fmt::print("{:<12} {:8.2f} s of motion in {:6.2f} s ({:.0f} x real time), {:.0f} blocks\n",
                 one.name, result.simulated_time, result.wall_time,
                 result.simulated_time / result.wall_time, one.blocks);
    } else {
      fmt::print("{:<12} stopped: {}\n", one.name, result.outcome.reason);
    }
  }
}

// Output that a run leaves behind when it does not end. For any thread.
class Kept {
 public:
  explicit Kept(const sim::model::Scenario& scenario) {
    for (const sim::model::CaseSpec& one : scenario.cases) incomplete_.push_back(one.name);
  }
  void in(const std::string& partial_path) {
    const std::scoped_lock lock(mutex_);
    partial_path_ = partial_path;
  }
  void add(const sim::run::CaseOutput& one) {
    const std::scoped_lock lock(mutex_);
    if (one.result.outcome.interrupted) return;
    std::erase(incomplete_, one.name);
    complete_.push_back(one.name);
  }
  bool all_complete() const {
    const std::scoped_lock lock(mutex_);
    return incomplete_.empty();
  }

  std::string said() const {
    const std::scoped_lock lock(mutex_);
    if (partial_path_.empty()) return {};
    std::string text = complete_.empty()
                           ? "no complete case"
                           : fmt::format("complete cases {}", fmt::join(complete_, ", "));
    if (!incomplete_.empty()) {
      text += fmt::format("; interrupted {}", fmt::join(incomplete_, ", "));
    }
    return kept_in(partial_path_, text);
  }

 private:
  mutable std::mutex mutex_;
  std::string partial_path_;
  std::vector<std::string> complete_, incomplete_;
};

void write_touches(const sim::run::RunOutput& output, const Options& options) {
  const std::filesystem::path folder = options.get<std::string>("touches");
  std::filesystem::create_directories(folder);
  for (const sim::run::CaseOutput& one : output.cases) {
    sim::system::write_text_file((folder / (one.name + ".csv")).string(),
                                 sim::run::touches_csv(one.touches, one.chain.layout),
                                 options.has("force"));
  }
}

// Prints what a run has found; the exit status.
int print_output(const sim::run::RunOutput& output, const Options& options,
                 const sim::model::Scenario& scenario, const std::string& path) {
  const bool json = options.has("json"), quiet = options.has("quiet");
  if (options.has("touches")) write_touches(output, options);
  if (options.has("readings")) write_readings(output, options);
  bool finished = all_days_ended(output);
  for (const sim::run::CaseOutput& one : output.cases) finished &= one.result.outcome.finished;
  print_notes(output);
  if (json) {
    JsonList list;
    for (const auto& row : output.comparison) list.add(sim::evaluation::to_json(row));
    add_report_json(output, list);
    list.end();
  } else if (!quiet) {
    fmt::print("{}\n\n", scenario.title);
    print_outcomes(output);
    if (!output.comparison.empty() || scenario.tests.empty()) {
      fmt::print("\n{}", sim::evaluation::format_table(output.comparison));
    }
    print_tests(output, scenario);
    print_days(output);
    fmt::print("\nwritten to {}\n", path);
  }
  if (!finished && (json || quiet)) {
    for (const sim::run::CaseOutput& one : output.cases) {
      if (one.result.outcome.finished) continue;
      fmt::print(stderr, "case {} stopped: {}\n", one.name, one.result.outcome.reason);
    }
  }
  return finished ? kDone : kMachineStopped;
}

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
  const sim::model::Scenario scenario =
      sim::input::read_scenario(options.word(), options.list("set"));
  const std::string path =
      sim::run::writable_name(output_name(options, scenario.name, ""), options.has("force"));
  refuse_other_format(path);
  const auto& stop = stop_on_interrupt();
  std::optional<sim::run::RunStore> store;
  sim::run::RunControl control;
  control.threads = thread_count(options);
  control.stop = &stop;
  control.scratch_folder = std::filesystem::absolute(path).parent_path().string();
  Kept kept(scenario);
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
  sim::run::RunOutput output;
  try {
    output = sim::run::run_scenario(scenario, control);
    line.end();
    if (!kept.all_complete()) {
      print_interrupted(kept.said());
      return kInterrupted;
    }
    store->commit(output.comparison);
  } catch (const sim::system::SystemError& error) {
    line.end();
    fmt::print(stderr, "{}\n", error.what());
    if (const std::string said = kept.said(); !said.empty()) fmt::print(stderr, "{}\n", said);
    return kSystemFailed;
  } catch (const Interrupted&) {
    line.end();
    print_interrupted(kept.said());
    return kInterrupted;
  }

  return print_output(output, options, scenario, path);
}

}  // namespace servomill::tools

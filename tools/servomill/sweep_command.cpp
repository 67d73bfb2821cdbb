#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <iostream>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/simd.h"
#include "sim/sweep/point_series.h"
#include "sim/sweep/run_sweep.h"
#include "sim/sweep/sweep.h"
#include "sim/sweep/table.h"
#include "sim/sweep/table_csv.h"
#include "sim/system/output_name.h"
#include "sim/system/system_error.h"
#include "sim/system/worker_thread.h"
#include "tools/servomill/command.h"
#include "tools/servomill/interrupt.h"
#include "tools/servomill/sweep_lines.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

constexpr const char* kSynopsis = "SCENARIO.toml [-o OUT.h5] [--shard I/N] [--set KEY=VALUE]...";

void add_options(Options& options) {
  options.add()("output,o", po::value<std::string>()->value_name("OUT.h5"),
                "result file (default: name of the scenario with _sweep.h5, in this folder); "
                "OUT.csv is written beside it");
  options.add()("set", po::value<std::vector<std::string>>()->value_name("KEY=VALUE"),
                "changes a key of the scenario at all points");
  options.add()("points", po::value<std::string>()->default_value("")->value_name("A-B"),
                "runs these points only, counted from 1");
  options.add()("shard", po::value<std::string>()->value_name("I/N"),
                "runs one of N parts of the points and writes OUT.I-of-N.h5; see servomill merge");
  options.add()("keep-signals",
                "keeps the signals of every point: OUT.series/POINT.h5, as servomill run "
                "writes them; points that an earlier sweep ran without are run again");
  options.add()("threads,j", po::value<int>()->default_value(0)->value_name("N"),
                "threads (default: one a core); results do not depend on it");
  options.add()("retry-failed",
                "runs points again at which the program or the system failed, such as for lack of "
                "memory");
  options.add()("force,f", "replaces the result file if it exists");
  options.add()("json", "prints one JSON object a point and quantity");
  options.add()("csv", "prints the table as the CSV file has it, at the end");
  options.add()("quiet,q", "prints nothing but faults");
}

sim::sweep::Selection selection_of(const Options& options, const sim::sweep::Sweep& sweep) {
  return sim::sweep::read_selection(sweep.design().size(), options.get<std::string>("points"),
                                    options.has("shard") ? options.get<std::string>("shard") : "");
}

// Points that need not be run. What has a row needs its signals, too, if they are asked for.
std::vector<bool> points_done(const sim::sweep::SweepTable& table,
                              const sim::sweep::Selection& selection,
                              const sim::sweep::Sweep& sweep, const std::string& signals) {
  std::vector<bool> done;
  for (const sim::run::PointStatus status : table.statuses()) {
    const bool ran =
        status == sim::run::PointStatus::done || status == sim::run::PointStatus::stopped;
    done.push_back(status != sim::run::PointStatus::not_run &&
                   (signals.empty() || !ran ||
                    sim::sweep::has_point_series(signals, sweep, selection.point(done.size()))));
  }
  return done;
}

SweepLines lines_of(const Options& options, const sim::sweep::Sweep& sweep,
                    const sim::sweep::Selection& selection, const std::vector<bool>& done) {
  using Form = SweepLines::Form;
  const bool quiet = options.has("quiet") || options.has("csv");
  const Form form = options.has("json") ? Form::json : quiet ? Form::none : Form::table;
  return {form, sweep.design(), sweep.quantities(), selection, done};
}

void print_file(const std::string& path) {
  std::ifstream file(path);
  std::cout << file.rdbuf() << std::flush;
}

// SIMD levels of its points; if signals are kept also that of this process, which may have added
// signals to rows of another one.
std::vector<SimdLevel> levels_of(const sim::sweep::SweepTable& table, const std::string& signals) {
  std::vector<SimdLevel> levels = table.simd_levels();
  const bool is_new = std::find(levels.begin(), levels.end(), simd_level()) == levels.end();
  if (!signals.empty() && is_new) levels.push_back(simd_level());
  std::sort(levels.begin(), levels.end());
  return levels;
}

// Prints the estimate for the remaining points, if they are like the first: on standard error, and
// only if it is long or large.
void tell_estimate(sim::preparation::RunEstimate takes, std::uint64_t points, unsigned threads,
                   bool series) {
  const auto n = static_cast<double>(points);
  if (points > 0 && takes.is_thinned)
    fmt::print(stderr, "{}\n", sim::preparation::thinning_message(takes));
  takes.motion *= n;
  takes.rows *= n;
  takes.computing *= n / std::min(n, static_cast<double>(sim::system::thread_count(threads)));
  takes.size *= series ? n : 0.0;
  takes.file *= series ? n : 0.0;
  if (points == 0 || !sim::preparation::is_worth_telling(takes)) return;
  fmt::print(stderr, "estimate: {} points like the first: {}\n", points,
             sim::preparation::to_string(takes));
}

int status_of(const sim::sweep::StatusCounts& counts) {
  const auto count = [&](sim::run::PointStatus status) {
    return counts[static_cast<std::size_t>(status)];
  };
  const bool all_done = count(sim::run::PointStatus::stopped) == 0 &&
                        count(sim::run::PointStatus::refused) == 0 &&
                        count(sim::run::PointStatus::failed) == 0;
  return all_done ? kDone : kMachineStopped;
}

}  // namespace

int sweep_command(const Arguments& arguments) {
  Options options("sweep", kSynopsis,
                  "Runs a scenario at the points of its [sweep] table, prints one line for "
                  "each and writes one row a point to one HDF5 file. What an interrupted or killed "
                  "sweep has left is gone on with. Exit status 1: at some points the machine "
                  "stopped or the input was refused; their rows say why.",
                  "SCENARIO.toml");
  add_options(options);
  add_plugin_option(options);
  if (!options.parse(arguments)) return kDone;
  load_plugins(options);

  const sim::sweep::Sweep sweep(options.word(), options.list("set"));
  const sim::sweep::Selection selection = selection_of(options, sweep);
  std::string out = output_name(options, sweep.base().name, "_sweep");
  const std::string signals = options.has("keep-signals") ? sim::sweep::series_folder(out) : "";
  if (options.has("shard")) out = sim::sweep::shard_name(out, selection);
  const unsigned threads = thread_count(options);
  const bool force = options.has("force");
  out = sim::system::output_target(
      out, force ? sim::system::Existing::replaced : sim::system::Existing::resumed);
  sim::system::output_target(sim::sweep::csv_name(out), sim::system::Existing::replaced);
  const auto of_a_point = sweep.refuse_hopeless();

  constexpr std::int64_t kNotCounted = -1;
  std::atomic<std::int64_t> left = kNotCounted;
  std::atomic<bool> is_complete = false;
  const auto said = [&, partial = out + ".partial"] {
    const auto all = static_cast<std::int64_t>(selection.size());
    return kept_in(is_complete ? out : partial,
                   left == kNotCounted ? "its complete points"
                                       : fmt::format("{} complete points of {}", all - left, all));
  };
  const KeptWhenInterrupted when_interrupted(said);
  sim::sweep::SweepTable table(out, force, sweep.base(), sim::sweep::columns_of(sweep.base()),
                               selection);
  is_complete = table.is_complete();
  if (options.has("retry-failed")) table.forget(sim::run::PointStatus::failed);
  const std::vector<bool> done = points_done(table, selection, sweep, signals);
  left = std::count(done.begin(), done.end(), false);
  const bool quiet = options.has("quiet") || options.has("json") || options.has("csv");
  if (table.is_complete() && left == 0) {
    if (!quiet) fmt::print("{} holds all {} points already\n", out, selection.size());
    return status_of(table.counts());
  }
  const std::uint64_t there = selection.size() - table.counts()[0];
  const auto to_do = static_cast<std::uint64_t>(left);
  const std::uint64_t without_signals = to_do - table.counts()[0];
  const std::string path = table.is_complete() ? out : table.partial_path();
  if (there > 0 && !quiet) {
    fmt::print("{}: {} of {} points are there already\n", path, there, selection.size());
    if (without_signals > 0) fmt::print("{} of them lack signals, run again\n", without_signals);
  }

  if (of_a_point) tell_estimate(*of_a_point, to_do, threads, !signals.empty());

  const auto& stop = stop_on_interrupt();
  ProgressBar bar(options.has("quiet"));
  SweepLines lines = lines_of(options, sweep, selection, done);
  sim::sweep::SweepControl control;
  control.threads = threads;
  control.stop = &stop;
  control.keep = signals.empty() ? sim::run::Keep::comparison : sim::run::Keep::series;
  control.progress = [&](double share) { bar.show(share); };
  std::uint64_t still_without_signals = 0;
  control.batch_done = [&](std::vector<sim::sweep::SweepPoint>&& points) {
    for (const sim::sweep::SweepPoint& point : points) {
      if (signals.empty()) continue;
      sim::sweep::write_point_series(signals, sweep, point);
      if (point.result.cases.empty()) ++still_without_signals;
    }
    // a row that is there stays: the same point gives the same bits
    const auto rows = std::stable_partition(
        points.begin(), points.end(), [&](const sim::sweep::SweepPoint& point) {
          return table.statuses()[selection.place(point.index)] == sim::run::PointStatus::not_run;
        });
    if (rows != points.begin()) table.write({points.begin(), rows});
    left -= static_cast<std::int64_t>(points.size());
    bar.clear();
    for (const sim::sweep::SweepPoint& point : points) lines.add(point);
  };
  try {
    sim::sweep::run_sweep(sweep, selection, done, control);
  } catch (const Interrupted&) {
    bar.clear();
    print_interrupted(said());
    return kInterrupted;
  }
  bar.clear();
  lines.finish();
  tell_mixed_levels(out, levels_of(table, signals));
  if (left > 0) {
    print_interrupted(said());
    return kInterrupted;
  }
  if (!table.is_complete()) table.commit();
  if (options.has("csv")) print_file(sim::sweep::csv_name(out));
  if (!quiet) fmt::print("{}; written to {}\n", points_by_status(table.counts()), out);
  if (still_without_signals > 0) {
    fmt::print(stderr, "{}: {} points gave no signals\n", signals, still_without_signals);
    return kMachineStopped;
  }
  return status_of(table.counts());
}

}  // namespace servomill::tools

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <numeric>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/simd.h"
#include "sim/engine/stop_flag.h"
#include "sim/model/design.h"
#include "sim/model/forward.h"
#include "sim/preparation/estimate.h"
#include "sim/run/point_result.h"
#include "sim/sweep/point_series.h"
#include "sim/sweep/run_sweep.h"
#include "sim/sweep/selection.h"
#include "sim/sweep/sweep.h"
#include "sim/sweep/table.h"
#include "sim/sweep/table_csv.h"
#include "tools/servomill/command.h"
#include "tools/servomill/interrupt.h"
#include "tools/servomill/json_list.h"
#include "tools/servomill/progress_line.h"
#include "tools/servomill/sweep_lines.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

constexpr const char* kSummary =
    "Runs a scenario at the points of its [sweep] table, prints one line per point and writes one "
    "row per point to one HDF5 file. For samples it prints mean, standard deviation and 95 % "
    "interval of each quantity, and for quantities with a tolerance the probability of conformity "
    "with the guard band of ISO 14253-1. An interrupted or killed sweep is continued. Exit status "
    "1: at some points the machine stopped or the input was refused; their rows give the reason.";
constexpr const char* kSynopsis = "SCENARIO.toml [-o OUT.h5] [--shard I/N] [--set KEY=VALUE]...";

void add_sweep_options(Options& options) {
  options.add()("output,o", po::value<std::string>()->value_name("OUT.h5"),
                "result file (default: name of the scenario with _sweep.h5, in this folder); "
                "OUT.csv is written next to it");
  options.add()("set", po::value<std::vector<std::string>>()->value_name("KEY=VALUE"),
                "changes a key of the scenario at all points");
  options.add()("points", po::value<std::string>()->default_value("")->value_name("A-B"),
                "runs these points only, counted from 1");
  options.add()("shard", po::value<std::string>()->value_name("I/N"),
                "runs one of N parts of the points and writes OUT.I-of-N.h5; see servomill merge");
  options.add()("keep-signals",
                "keeps the signals of every point: OUT.series/POINT.h5, as servomill run "
                "writes them; points that an earlier sweep ran without them are run again");
  options.add()("threads,j", po::value<int>()->default_value(0)->value_name("N"),
                "threads (default: one per core); results do not depend on it");
  options.add()("retry-failed",
                "runs points again that failed because of the program or the system, for example "
                "for lack of memory");
  options.add()("force,f", "replaces the result file if it exists");
  options.add()("json", "prints a JSON list, one object per quantity of each point that is run");
  options.add()("csv", "prints the table at the end, as in the CSV file");
  options.add()("quiet,q", "prints only faults");
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

int status_of(const sim::sweep::StatusCounts& counts) {
  const auto count = [&](sim::run::PointStatus status) {
    return counts[static_cast<std::size_t>(status)];
  };
  const bool all_done = count(sim::run::PointStatus::stopped) == 0 &&
                        count(sim::run::PointStatus::refused) == 0 &&
                        count(sim::run::PointStatus::failed) == 0;
  return all_done ? kDone : kMachineStopped;
}

struct SweepFiles {
  std::string table;
  std::string signals;  // folder; empty: none are kept
};

// Files that a sweep writes; refused where it may not.
SweepFiles files_of(const Options& options, const sim::sweep::Sweep& sweep,
                    const sim::sweep::Selection& selection) {
  const std::string out = output_name(options, sweep.name(), "_sweep");
  const std::string signals = options.has("keep-signals") ? sim::sweep::series_folder(out) : "";
  const std::string shard = options.has("shard") ? options.get<std::string>("shard") : "";
  std::string table = sim::sweep::writable_table(out, selection, shard, options.has("force"));
  refuse_other_format(table);
  return {std::move(table), signals};
}

// Prints which points of a table are there before a sweep goes on.
void print_points_there(const sim::sweep::SweepTable& table, const std::string& file,
                        std::uint64_t to_do) {
  const auto& counts = table.counts();
  const std::uint64_t all = std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
  if (counts[0] == all) return;
  fmt::print("{}: {} of {} points already exist\n",
             table.is_complete() ? file : table.partial_path(), all - counts[0], all);
  if (to_do > counts[0]) fmt::print("{} of them lack signals, run again\n", to_do - counts[0]);
}

// Writes the signals of points; how many of them have none.
std::uint64_t write_signals(const std::string& folder, const sim::sweep::Sweep& sweep,
                            const std::vector<sim::sweep::SweepPoint>& points) {
  std::uint64_t without = 0;
  for (const sim::sweep::SweepPoint& point : points) {
    sim::sweep::write_point_series(folder, sweep, point);
    if (!point.result.cases) ++without;
  }
  return without;
}

// Writes the rows of points that have none. A row that is there stays: the same point gives the
// same bits.
void write_rows(sim::sweep::SweepTable& table, const sim::sweep::Selection& selection,
                std::vector<sim::sweep::SweepPoint>& points) {
  const auto rows =
      std::stable_partition(points.begin(), points.end(), [&](const sim::sweep::SweepPoint& point) {
        return table.statuses()[selection.place(point.index)] == sim::run::PointStatus::not_run;
      });
  if (rows != points.begin()) table.write({points.begin(), rows});
}

// Points that are left to be done, for the message of an interrupted sweep.
struct PointsLeft {
  PointsLeft(const std::string& table, std::uint64_t points)
      : file(table), all(static_cast<std::int64_t>(points)) {}

  std::string said() const {
    return kept_in(is_complete ? file : file + ".partial",
                   count == kNotCounted
                       ? "its complete points"
                       : fmt::format("{} complete points of {}", all - count, all));
  }

  static constexpr std::int64_t kNotCounted = -1;
  const std::string file;
  const std::int64_t all;
  std::atomic<std::int64_t> count = kNotCounted;
  std::atomic<bool> is_complete = false;  // the table has its name
};

bool is_sweep_quiet(const Options& options) {
  return options.has("quiet") || options.has("json") || options.has("csv");
}

// Says what there is and what is to come before a sweep goes on.
void tell_before(const Options& options, const sim::sweep::SweepTable& table,
                 const SweepFiles& files,
                 const std::optional<sim::preparation::RunEstimate>& of_a_point,
                 std::uint64_t to_do, ProgressLine& line) {
  const auto hidden = line.hidden();
  if (!is_sweep_quiet(options)) print_points_there(table, files.table, to_do);
  if (of_a_point) {
    tell_estimate(*of_a_point, to_do, thread_count(options), !files.signals.empty());
  }
}

// Names parts of the scenario that a sweep omits.
void tell_left_out(const sim::sweep::Sweep& sweep, ProgressLine& line) {
  const auto hidden = line.hidden();
  for (const std::string& note : sweep.left_out()) fmt::print(stderr, "note: {}\n", note);
}

// Prints that nothing is left to be done; the exit status.
int print_complete(const Options& options, const sim::sweep::SweepTable& table,
                   const SweepFiles& files, std::uint64_t points) {
  if (options.has("json")) JsonList().end();
  if (!is_sweep_quiet(options)) {
    fmt::print("{} already contains all {} points\n", files.table, points);
    print_statistics(files.table);
  }
  return status_of(table.counts());
}

// Prints the end of a sweep; the exit status.
int print_sweep_end(const Options& options, const sim::sweep::SweepTable& table,
                    const sim::model::SweepDesign& design, const SweepFiles& files,
                    std::uint64_t without_signals) {
  tell_refused_samples(design, table.counts());
  if (options.has("csv")) print_file(sim::sweep::csv_name(files.table));
  if (!is_sweep_quiet(options)) {
    print_statistics(files.table);
    fmt::print("{}; written to {}\n", points_by_status(table.counts()), files.table);
  }
  if (without_signals > 0) {
    fmt::print(stderr, "{}: {} points gave no signals\n", files.signals, without_signals);
    return kMachineStopped;
  }
  return status_of(table.counts());
}

}  // namespace

int sweep_command(const Arguments& arguments) {
  Options options("sweep", kSynopsis, kSummary, "SCENARIO.toml");
  add_sweep_options(options);
  add_plugin_option(options);
  if (!options.parse(arguments)) return kDone;
  if (options.has("json") && options.has("csv")) throw InputError({"--json"}, "excludes --csv");
  load_plugins(options);

  ProgressLine line(options);
  const sim::sweep::Sweep sweep(options.word(), options.list("set"));
  const sim::sweep::Selection selection = selection_of(options, sweep);
  const SweepFiles files = files_of(options, sweep, selection);
  const auto of_a_point = sweep.refuse_hopeless();
  tell_left_out(sweep, line);

  PointsLeft left(files.table, selection.size());
  const KeptWhenInterrupted when_interrupted([&left] { return left.said(); });
  sim::sweep::SweepTable table(files.table, options.has("force"), sweep.base(),
                               sim::sweep::columns_of(sweep.base()), selection);
  left.is_complete = table.is_complete();
  if (options.has("retry-failed")) table.forget(sim::run::PointStatus::failed);
  const std::vector<bool> done = points_done(table, selection, sweep, files.signals);
  left.count = std::count(done.begin(), done.end(), false);
  if (table.is_complete() && left.count == 0) {
    line.end();
    return print_complete(options, table, files, selection.size());
  }
  tell_before(options, table, files, of_a_point, static_cast<std::uint64_t>(left.count), line);

  SweepLines lines = lines_of(options, sweep, selection, done);
  sim::sweep::SweepControl control;
  control.threads = thread_count(options);
  control.stop = &stop_on_interrupt();
  control.keep = files.signals.empty() ? sim::run::Keep::comparison : sim::run::Keep::series;
  std::uint64_t still_without_signals = 0;
  control.batch_done = [&](std::vector<sim::sweep::SweepPoint>&& points) {
    if (!files.signals.empty())
      still_without_signals += write_signals(files.signals, sweep, points);
    write_rows(table, selection, points);
    left.count -= static_cast<std::int64_t>(points.size());
    const auto hidden = line.hidden();
    for (const sim::sweep::SweepPoint& point : points) lines.add(point);
  };
  try {
    sim::sweep::run_sweep(sweep, selection, done, control);
  } catch (const Interrupted&) {
    line.end();
    print_interrupted(left.said());
    return kInterrupted;
  }
  line.end();
  lines.finish();
  tell_mixed_levels(files.table, levels_of(table, files.signals));
  if (left.count > 0) {
    print_interrupted(left.said());
    return kInterrupted;
  }
  if (!table.is_complete()) table.commit();
  return print_sweep_end(options, table, sweep.design(), files, still_without_signals);
}

}  // namespace servomill::tools

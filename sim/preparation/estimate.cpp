#include "sim/preparation/estimate.h"
#include "sim/model/machine_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <system_error>
#include <vector>

#include "controllers/path/path_limits.h"
#include "plant/vocabulary/lanes.h"
#include "plant/vocabulary/move_list.h"
#include "plant/vocabulary/scratch_file.h"
#include "plant/vocabulary/stored_text.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/chip_regeneration.h"
#include "sim/engine/engaged_teeth.h"
#include "sim/engine/simulate.h"
#include "sim/evaluation/probed_part.h"
#include "sim/evaluation/quantity.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/cutting_force_plan.h"
#include "sim/preparation/prepared_case.h"
#include "sim/system/worker_thread.h"

namespace servomill::sim::preparation {
namespace {

constexpr double kGigabyte = 1e9;
// One core, measured with five axes. Alone a case makes up to 1.7e7, which recording and comparison
// take back; up to eight in lockstep make some 1e7 each.
constexpr double kTicksPerSecond = 1e7;
constexpr double kRowsPerSecond = 9e5;  // with five axes, where every tick is recorded
constexpr double kMemoryShare = 0.8;    // of the memory; the rest is the program's and the system's

// Columns of the recorded signals (sim/records/README.md); those that only some cases have are
// rounded up.
double columns_of(const model::Scenario& scenario) {
  constexpr double kOfRow = 27.0, kOfAxis = 10.0, kExtremesOfRow = 29.0, kExtremesOfAxis = 6.0;
  const auto axes = static_cast<double>(scenario.machine.joints().size());
  const double extremes = scenario.record.extremes ? kExtremesOfRow + kExtremesOfAxis * axes : 0.0;
  return kOfRow + kOfAxis * axes + extremes;
}

constexpr double kUsualCompression = 6.0, kMinCompression = 4.0;

bool needs_every_row(const model::QuantitySpec& quantity) {
  return evaluation::quantity_entry(quantity.name).needs_every_row();
}

std::string in_gigabytes(double bytes) { return fmt::format("{:.2g} GB", bytes / kGigabyte); }

std::string in_time(double seconds) {
  constexpr double kMinute = 60.0, kHour = 3600.0;
  if (seconds < 2.0 * kMinute) return fmt::format("{:.0f} s", seconds);
  if (seconds < 2.0 * kHour) return fmt::format("{:.0f} min", seconds / kMinute);
  return fmt::format("{:.3g} h", seconds / kHour);
}

// Probes, and quantities of balls that name no section, look at the whole path.
bool can_be_thinned(const model::Scenario& scenario) {
  return !scenario.record.period_is_given && !scenario.record.windows.limited() &&
         !scenario.record.extremes && scenario.probes.empty() &&
         std::none_of(scenario.quantities.begin(), scenario.quantities.end(),
                      [](const model::QuantitySpec& one) {
                        return needs_every_row(one) && one.sections.empty();
                      });
}

double compression_of(const model::Scenario& scenario) {
  return scenario.record.compression == records::kNoCompression ? 1.0 : kUsualCompression;
}

// Rows of short cases are held, as numbers and encoded for the file, of long ones two pages while
// they run and pages while they are compared; where the path of a cutter counts, so many places of
// it as are held at once, where that of a ball does, all.
double memory_of(const model::Scenario& scenario, std::span<const double> recorded, double row,
                 unsigned threads) {
  constexpr double kCaseRuns = 25e6, kCaseIsCompared = 8e6;
  constexpr double kPlaceOfCutter = 200.0, kPlaceOfBall = 100.0;
  const auto most_of_cutter = static_cast<double>(evaluation::PositionsHeld{}.most);
  const records::RowKeeping keeping;
  const double period = scenario.machine.nc.periods.seconds(scenario.record_period);
  const bool has_ball = std::any_of(
      scenario.quantities.begin(), scenario.quantities.end(),
      [](const model::QuantitySpec& one) { return needs_every_row(one) && one.sections.empty(); });
  double sum = system::resident_memory();
  double longest = 0.0;
  for (const double motion : recorded) {
    const double rows = motion / period;
    longest = std::max(longest, rows);
    const bool is_short = rows * row <= keeping.most_in_memory;
    sum += is_short ? rows * row * (1.0 + 1.0 / compression_of(scenario)) : kCaseIsCompared;
  }
  const double at_once =
      std::min<double>(system::thread_count(threads), static_cast<double>(recorded.size()));
  double places = has_ball ? longest * kPlaceOfBall : 0.0;
  if (!scenario.probes.empty()) places += std::min(longest, most_of_cutter) * kPlaceOfCutter;
  return sum + at_once * (kCaseRuns + places);
}

}  // namespace

RunEstimate estimate(const model::Scenario& scenario, std::span<const double> motions,
                     unsigned threads, std::span<const double> recorded) {
  RunEstimate out;
  double longest = 0.0, ticks = 0.0;
  const model::LoopPeriods& periods = scenario.machine.nc.periods;
  std::vector<double> in_rows(recorded.begin(), recorded.end());
  for (const double one : motions) {
    const double motion = one + scenario.settle_time;
    if (recorded.empty()) in_rows.push_back(motion);
    out.motion += motion;
    ticks += motion / periods.base;
    longest = std::max(longest, motion / periods.base);
  }
  out.rows = std::accumulate(in_rows.begin(), in_rows.end(), 0.0) /
             periods.seconds(scenario.record_period);
  const double row = columns_of(scenario) * static_cast<double>(sizeof(double));
  out.size = out.rows * row;
  out.is_thinned = out.size > scenario.record.max_size && can_be_thinned(scenario);
  out.file = out.is_thinned ? scenario.record.max_size / kMinCompression
                            : out.size / compression_of(scenario);
  out.memory = memory_of(scenario, in_rows, row, threads);
  out.temporary = static_cast<double>(ScratchFile::temporary_bytes());
  const double cores = std::min<double>(system::thread_count(threads), system::thread_count(0));
  const double of_tick =
      1.0 / kTicksPerSecond + (scenario.record.extremes ? 1.0 / kRowsPerSecond : 0.0);
  out.computing = std::max(longest, ticks / cores) * of_tick;
  return out;
}

namespace {

// The teeth of a case: computing time (s) and memory (bytes) beside those of its drives.
struct Teeth {
  double computing = 0.0, memory = 0.0;
};

// Mean number of edges along what is cut.
double mean_edges(const PlannedCutting& cutting) {
  const auto& rows = cutting.table.rows();
  double cut = 0.0, edges = 0.0;
  for (std::size_t n = 1; n < rows.size(); ++n) {
    const int engagement = std::max(rows[n - 1].teeth, rows[n].teeth);
    if (engagement < 0) continue;
    const double length = rows[n].s - rows[n - 1].s;
    cut += length;
    edges += length * cutting.teeth->edges(engagement);
  }
  return cut > 0.0 ? edges / cut : 0.0;
}

// All of the motion counts as a cut. Times as measured within 30 % with 15 to 67 edges.
Teeth teeth_of(const PreparedCase& one) {
  constexpr double kEdge = 0.02e-6, kRegeneratedEdge = 0.2e-6;  // s, of an edge in a step
  const PreparedParts parts = one.parts();
  const double step = one.tooth_step();
  if (step <= 0.0) return {};
  const double edges = one.duration() / step * mean_edges(*parts.cutting);
  if (!parts.scenario.cutting->regeneration) return {edges * kEdge, 0.0};
  return {edges * kRegeneratedEdge,
          engine::ChipRegeneration::memory(step, parts.cutting->teeth->longest_passage())};
}

}  // namespace

RunEstimate estimate(const model::Scenario& scenario, std::span<const PreparedCase> cases,
                     unsigned threads) {
  std::vector<double> motions;
  std::vector<double> recorded;
  for (const PreparedCase& one : cases) {
    motions.push_back(one.duration());
    recorded.push_back(one.recorded_duration());
  }
  RunEstimate out = estimate(scenario, motions, threads, recorded);
  const double cores = std::min<double>({static_cast<double>(system::thread_count(threads)),
                                         static_cast<double>(system::thread_count(0)),
                                         std::max(1.0, static_cast<double>(cases.size()))});
  for (const PreparedCase& one : cases) {
    const Teeth teeth = teeth_of(one);
    out.computing += teeth.computing / cores;
    out.memory += teeth.memory;
    if (one.spec().servo != model::ServoModel::cascade) continue;
    out.lockstep += (one.duration() + scenario.settle_time) / scenario.machine.nc.periods.base /
                    kTicksPerSecond;
    ++out.lanes;
  }
  for (const PreparedCase& one : cases) {
    const TrialRunsToCome trials = one.trial_runs();  // one after the other
    out.trial_runs += trials.number;
    out.computing += trials.motion / scenario.machine.nc.periods.base / kTicksPerSecond;
  }
  return out;
}

RunEstimate estimate_of_points(RunEstimate of_point, std::uint64_t points, unsigned threads) {
  const auto n = static_cast<double>(points);
  const double at_once = std::min(n, static_cast<double>(system::thread_count(threads)));
  if (n == 0.0) return {};
  const double of_thread = n / at_once;
  const double lanes = std::clamp(of_thread * of_point.lanes, 1.0, static_cast<double>(kLaneWidth));
  const double alone = of_point.computing - of_point.lockstep;  // >= 0, of one thread
  of_point.computing = of_thread * (alone + of_point.lockstep / lanes);
  of_point.lockstep *= of_thread / lanes;
  of_point.motion *= n;
  of_point.rows *= n;
  of_point.size *= n;
  of_point.file *= n;
  return of_point;
}

std::string to_string(const RunEstimate& estimate) {
  return fmt::format(
      "{} of motion, {:.2g} rows, {} of signals in a file of {}{}, {} of memory{}, about {} of "
      "computing{}",
      in_time(estimate.motion), estimate.rows, in_gigabytes(estimate.size),
      estimate.is_thinned ? "at most " : "", in_gigabytes(estimate.file),
      in_gigabytes(estimate.memory),
      estimate.temporary > 0.0
          ? fmt::format(", {} of temporary files (TMPDIR)", in_gigabytes(estimate.temporary))
          : "",
      in_time(estimate.computing),
      estimate.trial_runs > 0 ? fmt::format(" with {} trial runs", estimate.trial_runs) : "");
}

std::string thinning_message(const RunEstimate& estimate) {
  return fmt::format(
      "record.period_ms is not given: the {:.2g} rows are thinned so that the file takes at most "
      "{} (a quarter of record.max_size_GB = {:g}), densest where blocks end, axes reverse and the "
      "contour error changes, with minimum and maximum values in between; record.period_ms = {:g} "
      "records all",
      estimate.rows, in_gigabytes(estimate.file), estimate.file * kMinCompression / kGigabyte,
      estimate.motion / estimate.rows / ms);
}

std::vector<bool> sections_kept_whole(const model::Scenario& scenario,
                                      const std::vector<std::string>& sections) {
  std::vector<bool> out;
  for (const std::string& name : sections) {
    const auto& tests = scenario.tests;
    const auto& quantities = scenario.quantities;
    out.push_back(
        std::any_of(tests.begin(), tests.end(),
                    [&](const auto& one) { return one->name == name; }) ||
        std::any_of(quantities.begin(), quantities.end(), [&](const model::QuantitySpec& one) {
          return needs_every_row(one) &&
                 std::find(one.sections.begin(), one.sections.end(), name) != one.sections.end();
        }));
  }
  return out;
}

bool is_worth_telling(const RunEstimate& estimate) {
  constexpr double kMinute = 60.0;
  return estimate.computing > kMinute || estimate.size > kGigabyte ||
         estimate.temporary > kGigabyte;
}

void refuse_too_large(const model::Scenario& scenario, const RunEstimate& estimate, double memory) {
  const auto refuse = [&](const std::string& what) {
    throw InputError(
        {scenario.program.file},
        fmt::format("takes {} in {} cases and {:.2g} rows: {}, or record fewer rows: "
                    "record.period_ms = {:g}",
                    in_time(estimate.motion), scenario.cases.size(), estimate.rows, what,
                    scenario.machine.nc.periods.seconds(scenario.record_period) / ms));
  };
  const double max_size = scenario.record.max_size;
  if (!estimate.is_thinned && estimate.size > max_size) {
    refuse(fmt::format("{} of signals; must be <= record.max_size_GB = {:g}; raise it",
                       in_gigabytes(estimate.size), max_size / kGigabyte));
  }
  if (estimate.memory > kMemoryShare * memory) {
    refuse(fmt::format("{} of memory; must be <= the {} available; run fewer cases",
                       in_gigabytes(estimate.memory), in_gigabytes(kMemoryShare * memory)));
  }
}

namespace {

// Bytes that are free in a folder; none: the system does not tell.
std::optional<double> room_in(const std::string& folder) {
  std::error_code unknown;
  const auto space = std::filesystem::space(folder, unknown);
  if (unknown) return std::nullopt;
  return static_cast<double>(space.available);
}

}  // namespace

void refuse_full_disk(const model::Scenario& scenario, const RunEstimate& estimate,
                      const std::string& folder, double copies, std::optional<double> available) {
  const std::string where = folder.empty() ? "." : folder;
  if (!available) available = room_in(where);
  const double needed = copies * estimate.file;
  if (!available || needed <= *available) return;
  throw InputError({scenario.program.file},
                   fmt::format("takes {} of disk space while running; {} has {} free: lower "
                               "record.max_size_GB = {:g} or choose another file (--output)",
                               in_gigabytes(needed), where, in_gigabytes(*available),
                               scenario.record.max_size / kGigabyte));
}

namespace {

void refuse_without_room(const model::Scenario& scenario, std::string_view what, double needed,
                         std::optional<double> available) {
  if (needed <= 0.0) return;
  std::error_code unknown;
  const std::string folder = std::filesystem::temp_directory_path(unknown).string();
  if (!available && !unknown) available = room_in(folder);
  if (!available || needed <= *available) return;
  throw InputError({scenario.program.file},
                   fmt::format("its {} about {} of temporary files; {} has {} free: choose another "
                               "folder (TMPDIR)",
                               what, in_gigabytes(needed), folder, in_gigabytes(*available)));
}

}  // namespace

void refuse_full_temporary_folder(const model::Scenario& scenario, std::size_t moves,
                                  std::optional<double> available) {
  constexpr double kPlannedMove = 95.0;  // bytes, of a five-axis line (sim/records/README.md)
  const auto in_memory = static_cast<double>(controllers::PathOptions{}.plans_in_memory);
  const double needed = kPlannedMove * static_cast<double>(moves) - in_memory;
  refuse_without_room(scenario, "planned motion takes", needed, available);
}

void refuse_full_temporary_folder_of_rewritten(const model::Scenario& scenario, std::size_t moves,
                                               std::optional<double> available) {
  // bytes, of a five-axis line: its text, its move as rewritten and as read back
  constexpr double kText = 55.0, kMove = 72.0;
  const auto count = static_cast<double>(moves);
  const double text = kText * count;
  const double needed =
      (text > static_cast<double>(StoredText::kMaxInMemory) ? text : 0.0) +
      2.0 * std::max(0.0, kMove * count - static_cast<double>(MoveList::kMaxInMemory));
  refuse_without_room(scenario, "rewritten program takes at least", needed, available);
}

}  // namespace servomill::sim::preparation

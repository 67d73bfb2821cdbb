#include "sim/preparation/estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/system/background.h"
#include "sim/system/memory.h"

namespace servomill::sim {
namespace {

constexpr double kGigabyte = 1e9;
constexpr double kTicksPerSecond = 1e7;  // of one case on one core; measured with five axes
constexpr double kMemoryShare = 0.8;  // of the memory; the rest is the program's and the system's

// Of the signals of README, "The result file"; those that only some cases have are rounded up.
double columns_of(const MachineSettings& machine) {
  constexpr double kOfRow = 27.0, kOfAxis = 10.0;
  return kOfRow + kOfAxis * static_cast<double>(machine.joints().size());
}

std::string in_gigabytes(double bytes) { return fmt::format("{:.2g} GB", bytes / kGigabyte); }

std::string in_time(double seconds) {
  constexpr double kMinute = 60.0, kHour = 3600.0;
  if (seconds < 2.0 * kMinute) return fmt::format("{:.0f} s", seconds);
  if (seconds < 2.0 * kHour) return fmt::format("{:.0f} min", seconds / kMinute);
  return fmt::format("{:.3g} h", seconds / kHour);
}

}  // namespace

RunEstimate estimate(const Scenario& scenario, std::span<const double> motions, unsigned threads) {
  RunEstimate out;
  double longest = 0.0, ticks = 0.0;
  const LoopPeriods& periods = scenario.machine.nc.periods;
  for (const double one : motions) {
    const double motion = one + scenario.settle_time;
    out.motion += motion;
    ticks += motion / periods.base;
    longest = std::max(longest, motion / periods.base);
  }
  out.rows = out.motion / periods.seconds(scenario.record_period);
  out.size = out.rows * columns_of(scenario.machine) * static_cast<double>(sizeof(double));
  const double cores = std::min<double>(thread_count(threads), thread_count(0));
  out.computing = std::max(longest, ticks / cores) / kTicksPerSecond;
  return out;
}

RunEstimate estimate(const Scenario& scenario, std::span<const PreparedCase> cases,
                     unsigned threads) {
  std::vector<double> motions;
  for (const PreparedCase& one : cases) motions.push_back(one.duration());
  return estimate(scenario, motions, threads);
}

std::string to_string(const RunEstimate& estimate) {
  return fmt::format("{} of motion, {:.2g} rows, {} of signals, about {} of computing",
                     in_time(estimate.motion), estimate.rows, in_gigabytes(estimate.size),
                     in_time(estimate.computing));
}

bool is_worth_telling(const RunEstimate& estimate) {
  constexpr double kMinute = 60.0;
  return estimate.computing > kMinute || estimate.size > kGigabyte;
}

void refuse_too_large(const Scenario& scenario, const RunEstimate& estimate) {
  const auto refuse = [&](const std::string& limit) {
    throw InputError(
        {scenario.program.file},
        fmt::format("takes {} in {} cases and {} rows: {} of signals; must be <= {}, or record "
                    "fewer rows: record.period_ms = {:g}",
                    in_time(estimate.motion), scenario.cases.size(),
                    fmt::format("{:.2g}", estimate.rows), in_gigabytes(estimate.size), limit,
                    scenario.machine.nc.periods.seconds(scenario.record_period) / ms));
  };
  if (estimate.size > scenario.record.max_size) {
    refuse(
        fmt::format("record.max_size_GB = {:g}; raise it", scenario.record.max_size / kGigabyte));
  }
  const double memory = kMemoryShare * memory_of_process();
  if (estimate.size > memory) {
    refuse(fmt::format("the {} of memory that there are for them; run fewer cases",
                       in_gigabytes(memory)));
  }
}

}  // namespace servomill::sim

#include "sim/run/point_batch.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <exception>
#include <iterator>
#include <optional>
#include <utility>

#include "plant/vocabulary/interrupt.h"
#include "sim/engine/simulate.h"
#include "sim/evaluation/comparison.h"
#include "sim/evaluation/outputs_read.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/prepare_cases.h"
#include "sim/run/run_case.h"
#include "sim/run/run_identity.h"
#include "sim/run/test_comparison.h"
#include "sim/system/memory_limit.h"

namespace servomill::sim::run {
namespace {

constexpr double kRowBytes = 500.0;
constexpr double kMemoryShare = 0.25;  // of the machine's memory

BatchResult failure(std::exception_ptr error) {
  try {
    std::rethrow_exception(std::move(error));
  } catch (const Interrupted&) {
    throw;
  } catch (const InputError& refused) {
    return {PointStatus::refused, in_one_line(refused), {}};
  } catch (const std::bad_alloc&) {
    return {PointStatus::failed, "not enough memory", {}};
  } catch (const std::exception& failed) {
    return {PointStatus::failed, failed.what(), {}};
  }
}

// A point with its cases on the way to their results.
struct Point {
  const model::Scenario* scenario;
  std::vector<preparation::PreparedCase> cases;
  std::vector<std::optional<engine::CaseInputs>> inputs;
  std::vector<engine::CaseResult> results;
  std::exception_ptr error;
  std::size_t left = 0;      // of the cases, to be run
  bool interrupted = false;  // half a point is none
  engine::RunOutputs outputs = {};

  double rows() const {
    double sum = 0.0;
    for (const auto& in : inputs) {
      sum += (in->reference.duration() + in->settle_time) /
             in->machine.nc.periods.seconds(in->record_period);
    }
    return sum;
  }
};

// Outputs of the runs of a point that will be read.
engine::RunOutputs outputs_of(const model::Scenario& scenario, Keep keep) {
  engine::RunOutputs outputs;
  const bool reads_quantities_only =
      scenario.tests.empty() && scenario.probes.empty() && !scenario.day;
  if (keep == Keep::comparison && reads_quantities_only) {
    outputs = evaluation::outputs_read_by(scenario.quantities);
  }
  outputs.makes_rows_beside = false;
  return outputs;
}

engine::CaseInputs inputs_of(const Point& point, std::size_t number) {
  engine::CaseInputs inputs = point.cases[number].inputs();
  inputs.outputs = point.outputs;
  // rows that are left out are chosen by other signals
  if (inputs.keeping.thinning || inputs.windows.limited()) inputs.outputs.signals.reset();
  return inputs;
}

Point prepared(const model::Scenario& scenario, const BatchControl& control) {
  Point point{&scenario, {}, {}, {}, nullptr, 0, false, outputs_of(scenario, control.keep)};
  try {
    point.cases = preparation::prepare_cases(scenario, control.cache);
    point.inputs.reserve(point.cases.size());
    for (std::size_t k = 0; k < point.cases.size(); ++k) {
      point.inputs.push_back(inputs_of(point, k));
    }
    point.results.resize(point.cases.size());
    point.left = point.cases.size();
  } catch (const Interrupted&) {
    point.interrupted = true;
  } catch (...) {
    point.error = std::current_exception();
  }
  return point;
}

// One case of one point.
struct Run {
  Point* point;
  std::size_t number;
  std::vector<Run> same = {};  // cases of later points that would be the same run
  std::exception_ptr error = nullptr;

  engine::CaseInputs& inputs() const { return *point->inputs[number]; }
};

// The runs of some points, each once: with those that are the same as an earlier one.
std::vector<Run> runs_of(std::span<Point> points) {
  std::vector<Run> runs;
  std::vector<RunIdentity> identities;
  for (Point& point : points) {
    for (std::size_t number = 0; !point.error && number < point.inputs.size(); ++number) {
      Run run{&point, number};
      RunIdentity identity(point.cases[number], run.inputs(), number);
      const auto known = std::find_if(identities.begin(), identities.end(),
                                      [&](const auto& one) { return one.is_same_as(identity); });
      if (known != identities.end()) {
        runs[static_cast<std::size_t>(known - identities.begin())].same.push_back(std::move(run));
        continue;
      }
      runs.push_back(std::move(run));
      identities.push_back(std::move(identity));
    }
  }
  return runs;
}

// Runs that share lanes, at most eight; point after point, so that runs of one program and feed are
// neighbours: they share its interpolation and end together. In an order in which the first points
// are done with first.
std::vector<std::vector<Run>> groups_of(std::span<Point> points) {
  std::vector<std::vector<Run>> groups;
  for (Run& run : runs_of(points)) {
    auto open = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
      return group.size() < kLaneWidth && engine::share_lanes(group.front().inputs(), run.inputs());
    });
    if (open == groups.end()) open = groups.insert(groups.end(), std::vector<Run>());
    open->push_back(std::move(run));
  }
  const auto last_point = [](const std::vector<Run>& group) {
    return std::max_element(group.begin(), group.end(),
                            [](const Run& a, const Run& b) { return a.point < b.point; })
        ->point;
  };
  std::stable_sort(groups.begin(), groups.end(),
                   [&](const auto& a, const auto& b) { return last_point(a) < last_point(b); });
  return groups;
}

void simulate_group(std::span<Run> group, const engine::StopFlag& stop,
                    std::atomic<float>& progress, preparation::PreparationCache* cache) {
  std::vector<engine::CaseInputs*> together;
  for (const Run& run : group) together.push_back(&run.inputs());
  try {
    std::vector<engine::CaseResult> results =
        engine::simulate(together, stop, progress, cache != nullptr ? &cache->drives : nullptr);
    for (std::size_t k = 0; k < group.size(); ++k) {
      group[k].point->results[group[k].number] = std::move(results[k]);
    }
  } catch (const Interrupted&) {
    for (const Run& run : group) run.point->results[run.number].outcome.interrupted = true;
  } catch (...) {
    if (group.size() == 1) {
      group.front().error = std::current_exception();
      return;
    }
    // whose fault it was shows when each runs alone, with state of its own
    for (Run& run : group) {
      run.point->inputs[run.number].emplace(inputs_of(*run.point, run.number));
      simulate_group({&run, 1}, stop, progress, cache);
    }
  }
}

// A run has ended: so have those that would be the same.
void end_run(const Run& run) {
  const engine::CaseResult& result = run.point->results[run.number];
  const auto end_at = [&](Point& point) {
    if (run.error) point.error = run.error;
    point.interrupted |= result.outcome.interrupted;
    --point.left;
  };
  end_at(*run.point);
  for (const Run& other : run.same) {
    other.point->results[other.number] = result;
    end_at(*other.point);
  }
}

BatchResult compared(Point& point, Keep keep) {
  std::vector<CaseOutput> outputs;
  for (std::size_t k = 0; k < point.cases.size(); ++k) {
    outputs.push_back(output_of(point.cases[k], std::move(point.results[k])));
  }
  std::vector<evaluation::CaseData> data;
  std::vector<std::string> stopped;
  for (const CaseOutput& output : outputs) {
    data.push_back(output.data());
    const engine::Outcome& outcome = output.result.outcome;
    if (outcome.finished) continue;
    stopped.push_back(fmt::format("case {} stopped: {}", output.name, outcome.reason));
  }
  BatchResult result;
  result.rows = evaluation::compare(point.scenario->quantities, data);
  std::vector<evaluation::ComparisonRow> of_tests = rows_of_tests(*point.scenario, outputs);
  std::move(of_tests.begin(), of_tests.end(), std::back_inserter(result.rows));
  result.status = stopped.empty() ? PointStatus::done : PointStatus::stopped;
  result.reason = fmt::format("{}", fmt::join(stopped, "; "));
  if (keep == Keep::series) {
    result.cases = std::make_shared<const std::vector<CaseOutput>>(std::move(outputs));
  }
  return result;
}

BatchResult result_of(Point& point, Keep keep) {
  if (point.error) return failure(point.error);
  try {
    return compared(point, keep);
  } catch (...) {
    return failure(std::current_exception());
  }
}

}  // namespace

std::string_view name_of(PointStatus status) {
  constexpr std::array<std::string_view, kPointStatuses> kNames = {"not_run", "done", "stopped",
                                                                   "refused", "failed"};
  return kNames.at(static_cast<std::size_t>(status));
}

std::string in_one_line(const InputError& error) {
  std::vector<std::string> lines;
  for (const Fault& fault : error.faults()) {
    // of a key of the sweep the message says where it stands
    const bool swept = fault.message.starts_with("sweep.");
    const std::string place = swept ? "" : to_string(fault.place) + ": ";
    lines.push_back(place + fault.message);
  }
  return fmt::format("{}", fmt::join(lines, "; "));
}

double rows_at_once(unsigned threads) {
  return std::min(kMaxRows, kMemoryShare * system::memory_of_process() /
                                (kRowBytes * static_cast<double>(threads)));
}

void run_batch(std::span<const model::Scenario> points, const engine::StopFlag& stop,
               std::atomic<float>& progress,
               const std::function<void(std::vector<EndedPoint>&&)>& ended,
               const BatchControl& control) {
  for (std::size_t next = 0; next < points.size() && !stop;) {
    const std::size_t first = next;
    std::vector<Point> together;
    for (double rows = 0.0; next < points.size() && rows < control.rows; ++next) {
      together.push_back(prepared(points[next], control));
      rows += together.back().rows();
    }
    std::vector<bool> reported(together.size(), false);
    const auto tell_ended = [&] {
      std::vector<EndedPoint> now;
      for (std::size_t k = 0; k < together.size(); ++k) {
        Point& point = together[k];
        if (reported[k] || point.left > 0 || point.interrupted) continue;
        reported[k] = true;
        now.push_back({first + k, result_of(point, control.keep)});
      }
      if (!now.empty()) ended(std::move(now));
    };
    tell_ended();  // what cannot be run
    std::atomic<float> share = 0.0F;
    auto groups = groups_of(together);
    for (std::size_t g = 0; g < groups.size() && !stop; ++g) {
      simulate_group(groups[g], stop, share, control.cache);
      for (const Run& run : groups[g]) end_run(run);
      tell_ended();
      progress = (static_cast<float>(first) + static_cast<float>(together.size()) *
                                                  static_cast<float>(g + 1) /
                                                  static_cast<float>(groups.size())) /
                 static_cast<float>(points.size());
    }
  }
}

}  // namespace servomill::sim::run

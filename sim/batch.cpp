#include "sim/batch.h"

#include <fmt/format.h>

#include <array>
#include <cassert>
#include <exception>
#include <utility>

namespace servomill::sim {
namespace {

BatchResult run_point(const Scenario& scenario, const StopFlag& stop, std::atomic<float>& share,
                      Keep keep) {
  std::vector<PreparedCase> prepared = prepare_cases(scenario);
  BatchResult result;
  std::vector<CaseOutput> outputs;
  outputs.reserve(prepared.size());
  for (PreparedCase& one : prepared) outputs.push_back(one.run(stop, share));
  if (stop) return result;  // half a point is none
  std::vector<CaseData> data;
  std::vector<std::string> stopped;
  for (const CaseOutput& output : outputs) {
    data.push_back(output.data());
    const Outcome& outcome = output.result.outcome;
    if (outcome.finished) continue;
    stopped.push_back(fmt::format("case {} stopped: {}", output.name, outcome.reason));
  }
  result.rows = compare(scenario.quantities, data);
  result.status = stopped.empty() ? PointStatus::done : PointStatus::stopped;
  result.reason = fmt::format("{}", fmt::join(stopped, "; "));
  if (keep == Keep::series) result.cases = std::move(outputs);
  return result;
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

std::vector<BatchResult> run_batch(std::span<const Scenario> points, const StopFlag& stop,
                                   std::atomic<float>& progress, Keep keep) {
  std::vector<BatchResult> results;
  results.reserve(points.size());
  std::atomic<float> share = 0.0F;
  for (const Scenario& point : points) {
    if (stop) {
      results.emplace_back();
      continue;
    }
    try {
      results.push_back(run_point(point, stop, share, keep));
    } catch (const InputError& error) {
      results.push_back({PointStatus::refused, in_one_line(error), {}});
    } catch (const std::bad_alloc&) {
      results.push_back({PointStatus::failed, "not enough memory", {}});
    } catch (const std::exception& error) {
      results.push_back({PointStatus::failed, error.what(), {}});
    }
    progress = static_cast<float>(results.size()) / static_cast<float>(points.size());
  }
  return results;
}

}  // namespace servomill::sim

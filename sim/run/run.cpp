#include "sim/run/run.h"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <span>
#include <utility>

#include "plant/vocabulary/progress.h"
#include "sim/evaluation/comparison.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/prepare_cases.h"
#include "sim/preparation/stability_check.h"
#include "sim/run/case_pool.h"
#include "sim/run/isolated_case.h"
#include "sim/run/run_case.h"
#include "sim/run/run_output.h"
#include "sim/system/worker_thread.h"
#include "strategies/plugin_child.h"
#include "strategies/plugin_watch.h"

namespace servomill::sim::run {
namespace {

constexpr auto kProgressPeriod = std::chrono::milliseconds(20);

// Should a plug-in not return, what else is complete is kept.
[[noreturn]] void keep_others(const RunControl& control, const std::vector<CaseOutput>& outputs,
                              const CasePool& pool, std::size_t first) {
  for (std::size_t i = first; i < outputs.size(); ++i) {
    const bool is_complete = pool.has_ended(i) && !pool.failure(i);
    if (is_complete && control.case_done) control.case_done(outputs[i]);
  }
  strategies::PluginRescue::done();
}

SignalStorage storage_of(const RunControl& control) {
  return {control.scratch_folder, control.stores_signals};
}

// Processes for the cases with plug-ins, where these are isolated; nullptr for the others.
std::vector<std::unique_ptr<IsolatedCase>> isolated_cases(
    std::span<const preparation::PreparedCase> prepared, const RunControl& control) {
  std::vector<std::unique_ptr<IsolatedCase>> out(prepared.size());
  if (!strategies::plugins_are_isolated()) return out;
  for (std::size_t i = 0; i < prepared.size(); ++i) {
    if (!uses_plugin(prepared[i].spec())) continue;
    out[i] = std::make_unique<IsolatedCase>(prepared[i], storage_of(control));
  }
  return out;
}

// @param isolated  process of the case; nullptr: it runs in this one
CaseOutput run_one(const preparation::PreparedCase& prepared,
                   std::unique_ptr<IsolatedCase> isolated, const RunControl& control,
                   const engine::StopFlag& stop, std::atomic<float>& progress) {
  CaseOutput out = isolated == nullptr
                       ? run_case(prepared, stop, progress, storage_of(control))
                       : noted_output_of(prepared, isolated->simulate(stop, progress));
  progress = 1.0F;
  return out;
}

void teach(const model::Scenario& scenario, std::vector<preparation::PreparedCase>& cases,
           const RunControl& control) {
  const preparation::RunEstimate takes = preparation::estimate(scenario, cases, control.threads);
  if (takes.trial_runs > 0 && control.trials_come) control.trials_come(takes);
  preparation::teach(scenario, cases, control.cache);
}

RunOutput with_comparison(const model::Scenario& scenario, std::vector<CaseOutput> outputs) {
  RunOutput out;
  std::vector<evaluation::CaseData> data;
  for (const CaseOutput& output : outputs) data.push_back(output.data());
  out.comparison = evaluation::compare(scenario.quantities, data);
  out.cases = std::move(outputs);
  return out;
}

}  // namespace

std::shared_ptr<const RunOutput> shared_run(const model::Scenario& scenario,
                                            const RunControl& control) {
  return std::make_shared<const RunOutput>(run_scenario(scenario, control));
}

const std::vector<evaluation::ComparisonRow>& comparison_of(const RunOutput& output) {
  return output.comparison;
}

preparation::RunEstimate check_scenario(const model::Scenario& scenario) {
  const std::vector<preparation::PreparedCase> prepared = preparation::prepare_untaught(scenario);
  std::vector<Fault> faults;
  for (const preparation::PreparedCase& one : prepared) {
    if (one.stops_with().empty()) continue;
    faults.push_back({one.spec().strategies.front().place,
                      fmt::format("case {}: {}", one.spec().name, one.stops_with())});
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  return preparation::estimate(scenario, prepared, 1);
}

void check_machine(const model::MachineSettings& machine) {
  preparation::check_stability(machine, machine.scale_delay, nullptr);
}

RunOutput run_scenario(const model::Scenario& scenario, const RunControl& control) {
  const auto begin = std::chrono::steady_clock::now();
  static const engine::StopFlag kNever = false;
  const engine::StopFlag& stop = control.stop != nullptr ? *control.stop : kNever;
  std::vector<preparation::PreparedCase> prepared =
      preparation::prepare_untaught(scenario, control.cache);
  teach(scenario, prepared, control);
  if (control.prepared)
    control.prepared(preparation::estimate(scenario, prepared, control.threads));

  const std::size_t count = prepared.size();
  // before there are threads that hold locks
  std::vector<std::unique_ptr<IsolatedCase>> isolated = isolated_cases(prepared, control);
  std::vector<CaseOutput> outputs(count);
  std::vector<std::atomic<float>> progress(count);
  const strategies::PluginRescue rescue;  // before a plug-in can fail
  CasePool pool(count, system::thread_count(control.threads), [&](std::size_t i) {
    outputs[i] = run_one(prepared[i], std::move(isolated[i]), control, stop, progress[i]);
  });
  Stage stage("", static_cast<double>(count));
  for (std::size_t i = 0; i < count;) {
    if (pool.wait(i, kProgressPeriod)) {
      if (pool.failure(i)) std::rethrow_exception(pool.failure(i));
      if (control.case_done) control.case_done(outputs[i]);
      ++i;
    } else if (strategies::PluginRescue::is_wanted()) {
      keep_others(control, outputs, pool, i);
    }
    double sum = 0.0;
    for (const auto& share : progress) sum += share;
    stage.reach(sum);
  }

  RunOutput out = with_comparison(scenario, std::move(outputs));
  out.wall_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

}  // namespace servomill::sim::run

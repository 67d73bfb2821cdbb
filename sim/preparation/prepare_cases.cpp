#include "sim/preparation/prepare_cases.h"

#include <algorithm>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/progress.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/estimate.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/refusals.h"
#include "sim/preparation/stability_check.h"

namespace servomill::sim::preparation {
namespace {

// Rows are left out of recordings that are too large.
void fit_to_file(const model::Scenario& scenario, std::vector<PreparedCase>& cases) {
  const RunEstimate takes = estimate(scenario, cases, 0);
  refuse_too_large(scenario, takes);
  for (PreparedCase& one : cases) {
    if (takes.is_thinned) one.thin(takes.file / static_cast<double>(cases.size()));
  }
}

}  // namespace

std::vector<PreparedCase> prepare_untaught(const model::Scenario& scenario,
                                           PreparationCache* cache) {
  PreparationCache own;  // the cases of one scenario share much, too
  if (cache == nullptr) cache = &own;
  Tick longest = scenario.machine.scale_delay;
  for (const model::CaseSpec& spec : scenario.cases) {
    if (!spec.machine) longest = std::max(longest, scenario.reading_delay_of(spec));
  }
  check_stability(scenario.machine, longest, cache);
  refuse_narrow_windows(scenario);
  std::vector<PreparedCase> prepared;
  prepared.reserve(scenario.cases.size());
  CaseFaults faults;
  for (const model::CaseSpec& spec : scenario.cases) {
    try {
      if (spec.machine) check_stability(*spec.machine, scenario.reading_delay_of(spec), cache);
      prepared.emplace_back(scenario, spec, cache);
    } catch (const InputError& error) {
      faults.add(spec.name, error);
    }
  }
  faults.report(scenario.cases.size());
  fit_to_file(scenario, prepared);
  refuse_absent_sections(scenario, prepared.front().sections());
  auto faults_of_circles = prepared.front().circular_faults(cache);
  if (!faults_of_circles.empty()) throw InputError(std::move(faults_of_circles));
  return prepared;
}

void teach(const model::Scenario& scenario, std::vector<PreparedCase>& cases,
           PreparationCache* cache) {
  const auto learns = [](const PreparedCase& one) { return one.has_to_learn(); };
  const auto learning = std::count_if(cases.begin(), cases.end(), learns);
  if (learning == 0) return;
  Stage lessons("cases that learn", static_cast<double>(learning), Steps::unlike);
  CaseFaults faults;
  for (PreparedCase& one : cases) {
    if (!learns(one)) continue;
    try {
      one.teach(cache);
    } catch (const InputError& error) {
      faults.add(one.spec().name, error);
    }
    lessons.advance();
  }
  faults.report(cases.size());
  fit_to_file(scenario, cases);  // some learn to move more slowly
}

std::vector<PreparedCase> prepare_cases(const model::Scenario& scenario, PreparationCache* cache) {
  PreparationCache own;
  if (cache == nullptr) cache = &own;
  std::vector<PreparedCase> cases = prepare_untaught(scenario, cache);
  teach(scenario, cases, cache);
  return cases;
}

}  // namespace servomill::sim::preparation

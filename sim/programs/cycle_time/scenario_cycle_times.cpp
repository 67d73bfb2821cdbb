// Cycle times of the cases of a scenario.
#include <algorithm>
#include <memory>

#include "sim/input/read_scenario.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/case_program.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/prepared_case.h"
#include "sim/programs/cycle_time/cycle_time.h"
#include "sim/programs/cycle_time/motion_booking.h"

namespace servomill::sim::programs {
namespace {

CycleTimeReport report_of(const model::Scenario& scenario, const model::CaseSpec& spec,
                          const preparation::PreparedParts& parts, double raise, unsigned threads) {
  const model::MachineSettings& machine = scenario.machine_of(spec);
  const controllers::ProgramSetup setup = preparation::program_setup(scenario, spec);
  CycleTimeReport report;
  report.program = scenario.program.file;
  report.files = {scenario.program.file};
  report.cases = {spec.name};
  report.warnings = parts.program.warnings;
  DurationSettings settings;
  settings.feed_override = scenario.program.feed_override;
  settings.start = machine.chain.layout.joints(preparation::machine_start(scenario, spec));
  settings.tool_centre_point = preparation::tool_centre_point(machine);
  settings.tools = &setup.tools;
  settings.file = scenario.program.file;
  MotionBooking booking(machine, settings, raise, threads);
  for (const Move& move : *parts.motion.moves) {
    if (is_motion(move.kind)) {
      booking.duration().add(move, true);
    } else {
      booking.duration().add_other(move);
    }
  }
  booking.finish(report, true);
  return report;
}

void refuse_unknown_cases(const model::Scenario& scenario, const std::vector<std::string>& cases) {
  std::vector<std::string_view> names;
  for (const model::CaseSpec& spec : scenario.cases) names.push_back(spec.name);
  for (const std::string& name : cases) {
    if (std::find(names.begin(), names.end(), name) != names.end()) continue;
    throw InputError({"--case " + name}, "is no case of the scenario" + did_you_mean(name, names));
  }
}

}  // namespace

std::vector<CycleTimeReport> scenario_cycle_times(const std::string& path,
                                                  const std::vector<std::string>& changes,
                                                  const std::vector<std::string>& cases,
                                                  double raise, unsigned threads) {
  const model::Scenario scenario = input::read_scenario(path, changes);
  refuse_unknown_cases(scenario, cases);
  std::vector<CycleTimeReport> out;
  std::vector<const preparation::PlannedMotion*> motions;
  preparation::PreparationCache cache;
  std::vector<std::unique_ptr<preparation::PreparedCase>> prepared;
  for (const model::CaseSpec& spec : scenario.cases) {
    if (!cases.empty() && std::find(cases.begin(), cases.end(), spec.name) == cases.end()) continue;
    prepared.push_back(std::make_unique<preparation::PreparedCase>(scenario, spec, &cache));
    prepared.back()->teach(&cache);
    const preparation::PreparedParts parts = prepared.back()->parts();
    const auto known = std::find(motions.begin(), motions.end(), &parts.motion);
    if (known != motions.end()) {
      out[static_cast<std::size_t>(known - motions.begin())].cases.push_back(spec.name);
      continue;
    }
    motions.push_back(&parts.motion);
    out.push_back(report_of(scenario, spec, parts, raise, threads));
  }
  return out;
}

}  // namespace servomill::sim::programs

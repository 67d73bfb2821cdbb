#include "sim/run/run_case.h"

#include <utility>

#include "sim/engine/recorded_signals.h"
#include "sim/engine/simulate.h"
#include "sim/evaluation/cutter_path.h"
#include "sim/evaluation/outputs_read.h"
#include "sim/evaluation/spindle_quantities.h"
#include "sim/model/machine_test.h"
#include "sim/model/scenario.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/run/case_warnings.h"
#include "sim/run/day_course.h"
#include "sim/run/demanded_motion.h"
#include "sim/run/machine_tests.h"

namespace servomill::sim::run {
namespace {

void probe(const preparation::PreparedParts& p, CaseOutput& out) {
  evaluation::ProbedPart part = evaluation::probe_part(
      {p.spec.name, out.result.servo, p.program.path, p.scenario.program.cutters, p.program.tips,
       out.chain, p.scenario.program.work_offset + p.spec.work_offset, p.imposed,
       p.scenario.stock.empty() ? nullptr : &p.scenario.stock,
       p.scenario.machine_of(p.spec).heat.get(),
       p.spec.cutting && p.scenario.cutting->regeneration},
      p.scenario.probes, p.scenario.cmm);
  out.probes = std::move(part.features);
  out.notes = std::move(part.notes);
  if (!p.scenario.part) return;
  out.part_fit =
      lay_on_nominal(p.spec.name, *p.scenario.part, p.distance_of_plan, out.probes, out.notes);
}

}  // namespace

evaluation::CaseData CaseOutput::data() const {
  return {name,
          &result.servo,
          sections,
          duration,
          blocks,
          result.outcome.finished,
          chain,
          probes.empty() ? nullptr : &probes,
          signal_delay,
          uncertain,
          result.left_out,
          spindle,
          day && !day->cycles.empty() ? std::optional(figures_of(*day)) : std::nullopt,
          demands};
}

CaseOutput output_of(const preparation::PreparedCase& prepared, engine::CaseResult result) {
  const preparation::PreparedParts p = prepared.parts();
  CaseOutput out;
  out.name = p.spec.name;
  out.result = std::move(result);
  if (p.rewritten != nullptr) out.program = p.rewritten->text;
  out.duration = p.motion.trajectory.duration();
  out.blocks = p.motion.blocks;
  out.sections = prepared.sections();
  out.demands = demands_of(p, out.result.demands);
  out.touches = p.program.touches;
  out.spindle = std::make_shared<const evaluation::SpindleMotion>(
      evaluation::spindle_motion(p.program.moves, p.scenario.machine_of(p.spec).nc));
  out.chain = p.scenario.machine_of(p.spec).chain;
  out.frame = model::work_frame(out.chain, p.scenario.program.work_offset + p.spec.work_offset);
  out.uncertain = p.scenario.uncertain;
  out.signal_delay = p.scenario.signal_delay_of(p.spec);
  for (std::size_t k = 0; k < p.lessons.size(); ++k) {
    if (p.lessons[k].trials.empty()) continue;
    out.learnt.push_back({std::string(p.spec.strategies[k].entry->name), p.lessons[k]});
  }
  if (!p.scenario.probes.empty() && out.result.outcome.finished) probe(p, out);
  if (out.result.outcome.finished) {
    for (const auto& test : p.scenario.tests) {
      out.tests.push_back(std::make_shared<const TestResult>(
          evaluate_test(*test, out.data(), p.scenario.program.feed_override)));
      if (auto note = note_of_creep(*out.tests.back(), test->dwell)) out.notes.push_back(*note);
    }
  }
  if (p.scenario.day && out.result.outcome.finished && out.result.heat.step > 0.0) {
    out.day = std::make_shared<const DayCourse>(course_of_day(p, out.result, out.duration));
  }
  for (std::string& note : notes_of_run(p, out.result)) {
    out.notes.push_back(std::move(note));
  }
  if (auto note = note_of_demands(p, out.demands)) out.notes.push_back(std::move(*note));
  return out;
}

CaseOutput noted_output_of(const preparation::PreparedCase& prepared, engine::CaseResult result) {
  CaseOutput out = output_of(prepared, std::move(result));
  const preparation::PreparedParts parts = prepared.parts();
  for (std::string& note : notes_of_uncorrectable(parts)) out.notes.push_back(std::move(note));
  for (std::string& note : notes_of_left_tables(parts)) out.notes.push_back(std::move(note));
  return out;
}

engine::CaseInputs inputs_with(const preparation::PreparedCase& prepared,
                               const SignalStorage& storage) {
  engine::CaseInputs out = prepared.inputs(storage.scratch_folder);
  if (!storage.is_encoded) return out;
  out.keeping.encodes = true;
  const model::Scenario& scenario = prepared.parts().scenario;
  // others than quantities read signals, too, and thinned rows have further ones
  const bool reads_all = !scenario.probes.empty() || !scenario.tests.empty() || scenario.day ||
                         out.keeping.thinning.has_value();
  if (reads_all) return out;
  out.keeping.read = evaluation::outputs_read_by(scenario.quantities).signals;
  if (!out.keeping.read) return out;
  out.keeping.read->insert(engine::kOfEveryRow.begin(), engine::kOfEveryRow.end());
  out.keeping.read->insert({"window", "in_window"});
  return out;
}

CaseOutput run_case(const preparation::PreparedCase& prepared, const engine::StopFlag& stop,
                    std::atomic<float>& progress, const SignalStorage& storage) {
  engine::CaseInputs given = inputs_with(prepared, storage);
  CaseOutput out = noted_output_of(prepared, engine::simulate(given, stop, progress));
  progress = 1.0F;
  return out;
}

}  // namespace servomill::sim::run

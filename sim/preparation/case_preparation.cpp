#include "sim/preparation/case_preparation.h"

#include <fmt/format.h>

#include <limits>
#include <utility>

#include "controllers/path/feed_reduction.h"
#include "controllers/path/tcp_motion.h"
#include "controllers/path/travel.h"
#include "controllers/translation/translated_program.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/parameters.h"
#include "sim/evaluation/nominal_part.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "sim/preparation/added_gains.h"
#include "sim/preparation/case_program.h"
#include "sim/preparation/cutting_force_plan.h"
#include "sim/preparation/estimate.h"
#include "sim/preparation/identified_heat.h"
#include "sim/preparation/identified_loops.h"
#include "sim/preparation/refusals.h"
#include "sim/preparation/rewritten_text.h"

namespace servomill::sim::preparation {
namespace {

// Title of a rewritten program.
std::string header_of(const model::Scenario& scenario, const model::CaseSpec& spec) {
  return fmt::format("{}, case {}", scenario.title, spec.name);
}

const plant::ErrorModel& errors_of(const model::Scenario& scenario, const std::string& model) {
  static const plant::ErrorModel kNone;
  const auto found = scenario.errors.find(model);
  return found == scenario.errors.end() ? kNone : found->second;
}

void add(system::MemoKey& key, const model::StrategySpec& spec) {
  key.add(spec.entry->name);
  key.add(spec.action);
  for (const ParameterSpec& parameter : spec.entry->parameters) {
    key.add(spec.parameters.is_word(parameter.name));
    if (spec.parameters.is_word(parameter.name)) {
      key.add(spec.parameters.word(parameter.name));
    } else {
      key.add(spec.parameters.number(parameter.name));
    }
  }
}

void add(system::MemoKey& key, const plant::Stock& stock) {
  key.add(stock.solids().size());
  for (const plant::StockSolid& solid : stock.solids()) {
    key.add(solid.index());
    if (const auto* box = std::get_if<plant::StockBox>(&solid)) {
      const auto& [from, to, turned] = *box;
      key.add(from);
      key.add(to);
      key.add(turned);
    } else {
      const auto& [centre, radius, from, to] = std::get<plant::StockCylinder>(solid);
      key.add(centre);
      for (const double value : {radius, from, to}) key.add(value);
    }
  }
}

void add(system::MemoKey& key, const std::map<int, plant::Cutter>& cutters) {
  key.add(cutters.size());
  for (const auto& [number, cutter] : cutters) {
    const auto& [radius, corner_radius, length, teeth, helix, runout, runout_direction] = cutter;
    key.add(number);
    key.add(teeth);
    for (const double value : {radius, corner_radius, length, helix, runout, runout_direction}) {
      key.add(value);
    }
  }
}

}  // namespace

CasePreparation::CasePreparation(const model::Scenario& scenario, const model::CaseSpec& spec,
                                 PreparationCache& cache)
    : scenario_(scenario),
      spec_(spec),
      machine_(scenario.machine_of(spec)),
      start_(machine_.chain.layout.joints(machine_start(scenario, spec))),
      cache_(cache) {}

SharedProgram CasePreparation::program() const {
  const controllers::ProgramSetup setup = program_setup(scenario_, spec_);
  system::MemoKey key;
  const auto shared = cache_.texts.shared(scenario_.program.shared_text);
  key.add_shared(shared.get());
  for (const auto& [name, text] : scenario_.program.subroutines) {
    key.add(name);
    key.add(text);
  }
  add(key, setup);
  add_probing(key);
  return cache_.programs.get(key, [&] {
    std::vector<Fault> warnings;
    std::shared_ptr<TouchedBodies> bodies;
    MoveList moves =
        read_program(scenario_, spec_, &warnings, [&] { return bodies = touched_bodies(); });
    refuse_unnumbered_tools(moves, scenario_.program.file);
    InterpretedProgram out(std::move(moves), std::move(warnings), setup);
    out.text = shared;
    out.probe = scenario_.touch_probe;
    if (bodies) out.touches = with_sections(bodies->touches(), out.moves);
    return out;
  });
}

void CasePreparation::add_probing(system::MemoKey& key) const {
  key.add_shared(scenario_.touch_probe.get());
  if (!scenario_.touch_probe) return;
  add(key, machine_.chain);
  add(key, errors_of(scenario_, spec_.machine_errors.value_or(scenario_.machine_errors)));
  key.add(machine_.nc.a_max);
  key.add(spec_.feedback_hardware);
  key.add(spec_.strategies.size());
  for (const model::StrategySpec& one : spec_.strategies) {
    add(key, one);
    add(key, errors_of(scenario_, one.model));
  }
}

StrategyParts CasePreparation::parts_at_rest(const Eigen::Vector3d& tip) const {
  StrategyParts out;
  for (const model::StrategySpec& one : spec_.strategies) {
    const SharedStrategy& made = out.strategies.emplace_back(strategy(one, tip));
    if (auto part = made->setpoint()) out.setpoints.push_back(std::move(part));
    if (made->displaces_feedback() && spec_.feedback_hardware) {
      out.feedback = made->feedback(machine_.nc.periods.seconds(scenario_.hardware.model_period));
    }
  }
  return out;
}

std::shared_ptr<TouchedBodies> CasePreparation::touched_bodies() const {
  if (!scenario_.touch_probe) return nullptr;
  parts_at_rest(Eigen::Vector3d::Zero());  // their faults are of the strategies, not of a touch
  return std::make_shared<TouchedBodies>(TouchedBodies::Setting{
      scenario_.touch_probe, model(spec_.machine_errors.value_or(scenario_.machine_errors)),
      model::work_frame(machine_.chain, scenario_.program.work_offset + spec_.work_offset), start_,
      machine_.nc.a_max, [this](const Eigen::Vector3d& tip) { return parts_at_rest(tip); }});
}

double CasePreparation::least_time(const InterpretedProgram& program) const {
  return controllers::least_time(program.moves, machine_.chain.layout.words(start_),
                                 path_options(machine_.nc, scenario_.program.feed_override));
}

const plant::ErrorModel& CasePreparation::errors(const std::string& name) const {
  return errors_of(scenario_, name);
}

SharedModel CasePreparation::model(const std::string& name) const {
  return model(name, machine_.chain);
}

SharedModel CasePreparation::model(const std::string& name,
                                   const plant::MachineChain& chain) const {
  const plant::ErrorModel& errors = errors_of(scenario_, name);
  system::MemoKey key;
  add(key, chain);
  add(key, errors);
  return cache_.models.get(key, [&] { return plant::VolumetricModel(chain, errors); });
}

SharedStrategy CasePreparation::strategy(const model::StrategySpec& spec,
                                         const Eigen::Vector3d& tip) const {
  const auto gain = [&](std::size_t j) {
    return spec.entry->reads_gains ? machine_.nc.cascade[j].Kv
                                   : std::numeric_limits<double>::quiet_NaN();
  };
  Joints Kv;
  Kv << gain(0), gain(1), gain(2), gain(3), gain(4);
  const Joints shift = machine_.chain.layout.joints(spec_.work_offset);
  const double added = added_gain(spec);
  system::MemoKey key;
  add(key, spec);
  add(key, machine_.chain);
  add(key, errors_of(scenario_, spec.model));
  key.add(tip);
  key.add(machine_.nc.lower);
  key.add(machine_.nc.upper);
  key.add(start_);
  key.add(shift);
  key.add(Kv);
  key.add(added);
  const model::LoopPeriods& periods = machine_.nc.periods;
  const double period = periods.seconds(periods.position);
  key.add(period);
  const auto heat = identified_heat(spec, spec_, machine_);
  if (heat) add(key, *heat);
  const auto loops = identified_loops(spec);
  if (loops != nullptr) add(key, *loops);
  return cache_.strategies.get(key, [&] {
    return make(spec, {machine_.chain.layout, *model(spec.model), tip, machine_.nc.lower,
                       machine_.nc.upper, start_, shift, Kv, added, period, heat, loops});
  });
}

// Ideal axes have no loops, and at a standstill without the hardware none acts.
std::shared_ptr<const strategies::IdentifiedLoops> CasePreparation::identified_loops(
    const model::StrategySpec& spec) const {
  const auto reads = spec.entry->reads_loops;
  if (reads == nullptr || !reads(spec.parameters) || spec_.servo == model::ServoModel::ideal) {
    return nullptr;
  }
  const model::MachineSettings& known = spec.machine ? *spec.machine : machine_;
  return preparation::identified_loops(known, scenario_.reading_delay_of(spec_),
                                       machine_.nc.periods.seconds(scenario_.hardware.model_period),
                                       cache_);
}

double CasePreparation::added_gain(const model::StrategySpec& spec) const {
  const auto wanted = spec.entry->wanted_margins;
  const std::optional<WantedMargins> margins =
      wanted != nullptr ? wanted(spec.parameters) : std::nullopt;
  if (!margins) return std::numeric_limits<double>::quiet_NaN();
  return preparation::largest_added_gain(scenario_, spec_, *margins, cache_);
}

std::vector<std::string> CasePreparation::check_added_gain(const model::StrategySpec& strategy,
                                                           const AddedGain& added) const {
  return preparation::check_added_gain(scenario_, spec_, strategy, added, cache_);
}

// A strategy knows the fault, but not the place of the key.
SharedStrategy CasePreparation::make(const model::StrategySpec& spec,
                                     const strategies::IdentifiedMachine& machine) const {
  try {
    return spec.entry->make(spec.parameters, spec.action, machine);
  } catch (const InputError& error) {
    throw fault_of(spec, spec_.name, error);
  }
}

// A rewritten program is G-code for LinuxCNC, whatever it was before.
controllers::ProgramSetup CasePreparation::setup_of_rewritten() const {
  controllers::ProgramSetup setup = controllers::translation::gcode_setup(
      program_text(scenario_.program), program_setup(scenario_, spec_));
  setup.reader = controllers::Reader::linuxcnc;
  return setup;
}

std::shared_ptr<const RewrittenProgram> CasePreparation::rewritten(
    const SharedMoves& moves, const SharedStrategy& strategy) const {
  system::MemoKey key;
  key.add_shared(moves.get());
  key.add_shared(strategy.get());
  key.add(header_of(scenario_, spec_));
  add(key, program_setup(scenario_, spec_));
  add(key, scenario_.machine.chain.layout);
  return cache_.rewritten.get(key, [&] {
    refuse_full_temporary_folder_of_rewritten(scenario_, moves->size());
    RewrittenText written =
        through_text([&](const PutMove& put) { rewrite(*strategy, *moves, put); },
                     {scenario_.program.file, spec_.name, header_of(scenario_, spec_),
                      scenario_.machine.chain.layout, setup_of_rewritten()});
    return RewrittenProgram{moves, strategy, std::move(written.moves), std::move(written.text)};
  });
}

// Motion of the linear axes under TCP control.
controllers::TipMotions CasePreparation::tip_motions(
    const MoveList& moves, const InterpretedProgram& program,
    const controllers::JointLimits& limits, const controllers::PathOptions& options) const {
  if (program.first_tip_move() == nullptr) return {};
  return controllers::tip_motions(moves, *tool_centre_point(machine_), program.tips, start_, limits,
                                  options, scenario_.program.file);
}

// A strategy knows the line that it cannot rewrite, and a printer that of a move that has no text,
// but not the file.
void CasePreparation::rewrite(const strategies::Strategy& strategy, const MoveList& moves,
                              const PutMove& put) const {
  try {
    strategy.rewrite(moves, put);
  } catch (const InputError& error) {
    const Fault& fault = error.faults().front();
    throw InputError({scenario_.program.file, fault.place.line, 0},
                     fmt::format("case {}: {}", spec_.name, fault.message));
  }
}

controllers::JointLimits CasePreparation::limits() const {
  return {machine_.nc.v_max, machine_.nc.a_max, machine_.nc.j_max};
}

SharedMotion CasePreparation::motion(const SharedMoves& moves,
                                     const InterpretedProgram& program) const {
  return motion(moves, program, limits());
}

SharedMotion CasePreparation::motion(const SharedMoves& moves, const InterpretedProgram& program,
                                     const controllers::JointLimits& limits, double feed) const {
  controllers::PathOptions options = path_options(machine_.nc, scenario_.program.feed_override);
  options.feed_override *= feed;
  system::MemoKey key;
  key.add_shared(moves.get());
  add(key, machine_.chain.layout);
  if (program.first_tip_move() != nullptr) add(key, machine_.chain);
  key.add(start_);
  key.add(machine_.nc.lower);
  key.add(machine_.nc.upper);
  add(key, limits);
  add(key, options);
  return cache_.motions.get(key, [&] { return plan(moves, program, limits, options); });
}

PlannedMotion CasePreparation::plan(const SharedMoves& moves, const InterpretedProgram& program,
                                    const controllers::JointLimits& limits,
                                    const controllers::PathOptions& options) const {
  controllers::TipMotions tip = tip_motions(*moves, program, limits, options);
  auto faults = controllers::travel_faults(*moves, machine_.chain.layout, start_, machine_.nc.lower,
                                           machine_.nc.upper, scenario_.program.file, tip);
  if (!faults.empty()) throw InputError(std::move(faults));
  refuse_full_temporary_folder(scenario_, moves->size());
  if (const auto slowed = controllers::slowed_inverse_time(*moves, machine_.chain.layout, start_,
                                                           limits, options)) {
    tip.slowed.push_back(*slowed);
  }
  double blocks = 0.0;
  for (const Move& move : *moves) blocks += is_motion(move.kind) ? 1.0 : 0.0;
  return PlannedMotion{
      moves, controllers::plan(*moves, machine_.chain.layout, start_, limits, options, tip), blocks,
      std::move(tip.slowed)};
}

SharedCutting CasePreparation::cutting(const SharedProgram& program) const {
  if (!spec_.cutting) return nullptr;
  const CuttingPlanInputs inputs = {program,
                                    machine_.chain,
                                    start_,
                                    scenario_.program.work_offset + spec_.work_offset,
                                    scenario_.stock,
                                    scenario_.program.cutters,
                                    scenario_.cutting->coefficients,
                                    scenario_.cutting->teeth,
                                    scenario_.cutting->regeneration,
                                    scenario_.cutting->actual_depth,
                                    machine_.structural_modes,
                                    scenario_.program.file,
                                    scenario_.cutting->place};
  system::MemoKey key;
  key.add_shared(program.get());
  add(key, machine_.chain);
  key.add(start_);
  key.add(inputs.work_offset);
  add(key, inputs.stock);
  add(key, inputs.cutters);
  key.add(inputs.teeth);
  key.add(inputs.regeneration);
  key.add(inputs.displaced);
  for (const plant::StructuralMode& mode : inputs.modes) {
    key.add(mode.direction);
    for (const double value : {mode.compliance, mode.mode.w, mode.mode.zeta}) key.add(value);
  }
  for (const plant::NamedCoefficient& K : plant::kCuttingCoefficients) {
    key.add(inputs.coefficients.*K.member);
  }
  return cache_.cuttings.get(key, [&] { return plan_cutting(inputs); });
}

double CasePreparation::distance_of_plan() const {
  if (!scenario_.part) return 0.0;
  const std::shared_ptr<const metrology::TriangleMesh>& mesh = scenario_.part->mesh;
  system::MemoKey key;
  key.add_shared(mesh.get());
  for (const metrology::ProbeSpec& probe : scenario_.probes) {
    for (const plant::ProbeTarget& target : probe.feature.targets) key.add(target.point);
  }
  return cache_.plan_distances
      .get(key,
           [&] {
             return PlanDistance{mesh, evaluation::largest_distance(scenario_.probes, *mesh)};
           })
      ->distance;
}

}  // namespace servomill::sim::preparation

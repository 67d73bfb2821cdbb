#include "sim/preparation/prepared_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "plant/kinematics/chain.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/units.h"
#include "sim/engine/depth_of_cut.h"
#include "sim/engine/engaged_teeth.h"
#include "sim/engine/simulate.h"
#include "sim/evaluation/nominal_part.h"
#include "sim/model/machine.h"
#include "sim/model/machine_test.h"
#include "sim/model/scenario.h"
#include "sim/preparation/case_preparation.h"
#include "sim/preparation/chatter_check.h"
#include "sim/preparation/estimate.h"
#include "sim/preparation/identified_heat.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/refusals.h"
#include "sim/preparation/stability_check.h"
#include "sim/preparation/teaching.h"
#include "sim/preparation/tooth_step.h"
#include "strategies/displaced_blocks.h"
#include "strategies/plugin_child.h"

namespace servomill::sim::preparation {

namespace {

// rad/s during each move; 0 while the spindle stands.
std::vector<double> spindle_speeds(const MoveRange& moves) {
  std::vector<double> out;
  double speed = 0.0;
  for (const Move& move : moves) {
    if (move.kind == MoveKind::spindle) speed = move.direction == 0 ? 0.0 : std::abs(move.value);
    out.push_back(speed);
  }
  return out;
}

// Rows of the record period tell of every tick, of an ideal servo of every position period: that is
// when its axes move.
void record_every_tick(engine::CaseInputs& inputs) {
  const model::LoopPeriods& periods = inputs.machine.nc.periods;
  const Tick step = inputs.servo == model::ServoModel::ideal ? periods.position : 1;
  inputs.keeping.thinning = {.every = static_cast<std::size_t>(inputs.record_period / step),
                             .row_period = periods.seconds(step)};
  inputs.record_period = step;
}

}  // namespace

struct PreparedCase::Parts {
  const model::Scenario& scenario;
  const model::CaseSpec& spec;
  SharedProgram program;
  std::vector<SharedStrategy> strategies;
  std::shared_ptr<const RewrittenProgram> rewritten;  // nullptr: the original program runs
  SharedMotion motion;
  SharedModel machine_errors, imposed;
  const plant::ErrorModel* component_errors = nullptr;  // those of machine_errors
  SharedCutting cutting;
  Tick tooth_step = 0;
  Joints machine_start;
  std::optional<records::ThinningLimits> thinning = {};  // of its recording
  double distance_of_plan = 0.0;                         // m, of nominal points from the part
  std::vector<std::string> warnings = {};                // margins, limits of strategies
  std::string stops_with = {};  // why a plug-in could not rewrite the program
  std::vector<servomill::strategies::Lesson> lessons = {};  // of each strategy

  const model::MachineSettings& machine() const { return scenario.machine_of(spec); }
  SharedMoves apply_strategies(const CasePreparation& prepare);
  void plan_cut(const CasePreparation& prepare);
  LearningCase learning(const CasePreparation& prepare);
  bool learns(std::size_t number) const { return strategies[number]->learning() != nullptr; }
  void teach(const CasePreparation& prepare);
  engine::CaseInputs inputs_on(const model::MachineSettings& machine,
                               const plant::VolumetricModel& errors,
                               const plant::ErrorModel* components,
                               const std::string& scratch_folder) const;
  void check_added_gain(const CasePreparation& prepare, const model::StrategySpec& strategy);
};

// Checks the gain of the last strategy.
void PreparedCase::Parts::check_added_gain(const CasePreparation& prepare,
                                           const model::StrategySpec& strategy) {
  const auto added = strategies.back()->added_gain();
  if (!added) return;
  refuse_other_tip(strategy, *program, scenario.program.file, spec.name);
  for (std::string& note : prepare.check_added_gain(strategy, *added)) {
    warnings.push_back(std::move(note));
  }
}

// The cut and, of single teeth, their steps. A mode that the tick does not resolve is refused
// before anything is planned.
void PreparedCase::Parts::plan_cut(const CasePreparation& prepare) {
  refuse_regeneration(scenario, spec, prepare.start());
  const bool vibrates = spec.cutting && scenario.cutting->regeneration;
  const double mode = vibrates ? highest_mode(machine()) : 0.0;
  const auto step = [&](double passing_frequency) {
    return preparation::tooth_step(*scenario.cutting, passing_frequency, mode, machine().nc.periods,
                                   spec.servo);
  };
  constexpr double kHardly = 1e-6;  // 1/s
  if (vibrates) step(kHardly);
  cutting = prepare.cutting(program);
  if (cutting && cutting->teeth) tooth_step = step(cutting->teeth->passing_frequency());
}

// Makes the strategies, each of which may rewrite the moves of the one before. Returns the moves
// that run.
SharedMoves PreparedCase::Parts::apply_strategies(const CasePreparation& prepare) {
  SharedMoves moves(program, &program->moves);
  for (const model::StrategySpec& strategy : spec.strategies) {
    refuse_second(strategy, spec);
    strategies.push_back(prepare.strategy(strategy, program->first_tip));
    refuse_undeclared_feedback(strategy, *strategies.back());
    refuse_unread_scale(strategy, *strategies.back(), machine(), spec.name);
    check_added_gain(prepare, strategy);
    for (const std::string& note : strategies.back()->notes()) {
      warnings.push_back(
          fmt::format("case {}: strategy {}: {}", spec.name, strategy.entry->name, note));
    }
    if (!strategies.back()->rewrites()) continue;
    refuse_rewritten_probing(strategy, *program, spec.name);
    refuse_tip_moves(strategy, *strategies.back(), *program, scenario.program.file, spec.name);
    try {
      rewritten = prepare.rewritten(moves, strategies.back());
    } catch (const servomill::strategies::PluginFailed& failed) {
      if (stops_with.empty()) stops_with = failed.what();
      continue;
    } catch (const servomill::strategies::TooManyBlocks& error) {
      throw InputError(strategy.place, fmt::format("case {}: strategy {}: {}", spec.name,
                                                   strategy.entry->name, error.what()));
    }
    moves = {rewritten, &rewritten->moves};
  }
  return moves;
}

LearningCase PreparedCase::Parts::learning(const CasePreparation& prepare) {
  LearningCase learning{prepare, scenario,   spec,      program, machine_errors, component_errors,
                        {},      strategies, rewritten, motion,  warnings};
  learning.inputs = [this](const auto& machine, const auto& errors, const auto* components) {
    return inputs_on(machine, errors, components, {});
  };
  return learning;
}

// Strategies that learn do so from runs with those before and behind them, one after the other.
void PreparedCase::Parts::teach(const CasePreparation& prepare) {
  LearningCase taught = learning(prepare);
  lessons.resize(strategies.size());
  for (std::size_t k = 0; k < strategies.size(); ++k) {
    if (learns(k)) lessons[k] = preparation::teach(taught, k);
  }
}

PreparedCase::PreparedCase(const model::Scenario& scenario, const model::CaseSpec& spec,
                           PreparationCache* cache)
    : parts_(new Parts{scenario, spec, {}, {}, {}, {}, {}, {}, nullptr, {}, 0, Joints::Zero()}) {
  PreparationCache own;
  const CasePreparation prepare(scenario, spec, cache != nullptr ? *cache : own);
  Parts& parts = *parts_;
  parts.program = prepare.program();
  parts.machine_start = prepare.start();
  parts.distance_of_plan = prepare.distance_of_plan();
  if (parts.program->path.size() == 0) throw InputError({scenario.program.file}, "moves no axis");
  refuse_absent_axes(*parts.program, scenario);
  refuse_growing_part(scenario, spec);
  refuse_standing_spindle(*parts.program, scenario);
  refuse_turned_tip(*parts.program, scenario, spec);
  const double least_time = prepare.least_time(*parts.program);
  refuse_endless(scenario, least_time);
  // planning takes memory and time for every second of motion
  const std::vector<double> motions(scenario.cases.size(), least_time);
  std::vector<double> recorded;  // windows are known once it is planned
  if (scenario.record.windows.limited()) recorded.assign(motions.size(), 0.0);
  refuse_too_large(scenario, estimate(scenario, motions, 0, recorded));
  refuse_start_outside(scenario, parts.machine(), prepare.start());

  const SharedMoves moves = parts.apply_strategies(prepare);

  // what the machine can do
  parts.motion = prepare.motion(moves, *parts.program);
  refuse_endless(scenario, parts.motion->trajectory.duration());
  const std::string& machine_errors = spec.machine_errors.value_or(scenario.machine_errors);
  parts.machine_errors = prepare.model(machine_errors);
  parts.component_errors = &prepare.errors(machine_errors);
  if (!scenario.imposed.empty()) parts.imposed = prepare.model(scenario.imposed);
  parts.plan_cut(prepare);
  LearningCase lessons = parts.learning(prepare);
  for (std::size_t k = 0; k < parts.strategies.size(); ++k) {
    if (parts.learns(k)) refuse_lessons(lessons, k);
  }
}

TrialRunsToCome PreparedCase::trial_runs() const {
  const Parts& p = *parts_;
  TrialRunsToCome out;
  if (!p.lessons.empty()) return out;  // they have taken place
  for (std::size_t k = 0; k < p.strategies.size(); ++k) {
    if (!p.learns(k) || !p.spec.strategies[k].recordings.empty()) continue;
    const servomill::strategies::TrialSetup setup = p.strategies[k]->learning()->trials();
    out.number += setup.runs;
    out.motion += setup.runs * duration() / setup.feed;
  }
  return out;
}

bool PreparedCase::has_to_learn() const {
  const Parts& p = *parts_;
  if (!p.lessons.empty()) return false;
  for (std::size_t k = 0; k < p.strategies.size(); ++k) {
    if (p.learns(k)) return true;
  }
  return false;
}

void PreparedCase::teach(PreparationCache* cache) {
  PreparationCache own;
  parts_->teach({parts_->scenario, parts_->spec, cache != nullptr ? *cache : own});
}

void PreparedCase::thin(double bytes) {
  parts_->thinning = {.bytes = bytes,
                      .keep_all = sections_kept_whole(parts_->scenario, sections())};
}

double PreparedCase::duration() const { return parts_->motion->trajectory.duration(); }

double PreparedCase::recorded_duration() const {
  constexpr double kStep = 10.0 * ms;  // s, between two looks at short programs
  constexpr double kMaxLooks = 1e5;
  const Parts& p = *parts_;
  const double whole = duration() + p.scenario.settle_time;
  const engine::RecordingWindows windows(p.scenario.record.windows, p.program->path);
  if (!windows.limited()) return whole;
  const engine::ProgramPath::Indices pieces = p.program->path.pieces_of(*p.motion->moves);
  const double looks = std::clamp(whole / kStep, 1.0, kMaxLooks);
  controllers::Trajectory::Cursor cursor{};
  double inside = 0.0;
  for (double n = 0.5; n < looks; n += 1.0) {
    const double t = n / looks * whole;
    if (windows.contains(pieces[p.motion->trajectory.at(t, cursor).move], t)) inside += 1.0;
  }
  return inside / looks * whole;
}

double PreparedCase::tooth_step() const {
  return parts_->machine().nc.periods.seconds(parts_->tooth_step);
}

PreparedCase::~PreparedCase() = default;
PreparedCase::PreparedCase(PreparedCase&&) noexcept = default;

engine::CaseInputs PreparedCase::inputs(const std::string& scratch_folder) const {
  const Parts& p = *parts_;
  return p.inputs_on(p.machine(), *p.machine_errors, p.component_errors, scratch_folder);
}

engine::CaseInputs PreparedCase::Parts::inputs_on(const model::MachineSettings& machine,
                                                  const plant::VolumetricModel& errors,
                                                  const plant::ErrorModel* components,
                                                  const std::string& scratch_folder) const {
  const Parts& p = *this;
  model::FeedbackHardware hardware = p.scenario.hardware;
  hardware.connected = p.spec.feedback_hardware;
  engine::CaseInputs inputs{machine,
                            errors,
                            p.imposed.get(),
                            p.motion->trajectory,
                            p.program->path,
                            p.program->tips,
                            p.spec.servo,
                            hardware,
                            {},
                            nullptr,
                            {},
                            p.scenario.record_period,
                            p.scenario.settle_time,
                            p.scenario.record.format,
                            {.folder = scratch_folder,
                             .compression = p.scenario.record.compression,
                             .thinning = p.thinning}};
  inputs.pieces = p.program->path.pieces_of(*p.motion->moves);
  if (p.cutting) {
    inputs.cutting = &p.cutting->table;
    inputs.teeth = p.cutting->teeth.get();
    inputs.tooth_step = p.tooth_step;
    inputs.regeneration = p.scenario.cutting->regeneration;
    inputs.displaced_cuts = p.cutting->displaced.get();
    inputs.wear = p.spec.wear;
  }
  if (machine.heat) {
    inputs.component_errors = components;
    inputs.spindle_speeds = spindle_speeds(*p.motion->moves);
    inputs.known_heat = known_heat_of(p.spec, machine);
  }
  inputs.records_orientation =
      std::any_of(p.scenario.tests.begin(), p.scenario.tests.end(),
                  [](const auto& test) { return test->needs_orientation(); });
  inputs.windows = {p.scenario.record.windows, p.program->path};
  if (p.scenario.record.extremes) record_every_tick(inputs);
  inputs.stops_with = p.stops_with;
  if (!p.stops_with.empty()) return inputs;
  const model::LoopPeriods& periods = machine.nc.periods;
  for (std::size_t k = 0; k < p.strategies.size(); ++k) {
    const auto& strategy = p.strategies[k];
    if (auto part = strategy->setpoint()) inputs.setpoints.push_back(std::move(part));
    if (auto part = strategy->position_loop(periods.seconds(periods.position))) {
      inputs.position_loop_terms.push_back(
          {std::string(p.spec.strategies[k].entry->name), std::move(part)});
    }
    if (strategy->displaces_feedback()) inputs.feedback = strategy.get();
    if (strategy->rewrites()) inputs.program_displaces_rotary |= strategy->displaces_rotary();
    if (p.scenario.record.uncorrectable && strategy->uncorrectable(p.machine_start)) {
      inputs.recorded_corrections.push_back(strategy.get());
    }
  }
  return inputs;
}

PreparedParts PreparedCase::parts() const {
  const Parts& p = *parts_;
  return {p.scenario,        p.spec,          *p.program,      *p.motion,          p.strategies,
          p.rewritten.get(), p.cutting.get(), p.imposed.get(), p.distance_of_plan, p.warnings,
          p.lessons};
}

const std::string& PreparedCase::stops_with() const { return parts_->stops_with; }

const model::CaseSpec& PreparedCase::spec() const { return parts_->spec; }

const std::vector<std::string>& PreparedCase::sections() const {
  return parts_->program->path.sections();
}

std::map<std::string, std::vector<Eigen::Vector3d>> PreparedCase::nominal_positions(
    const std::set<std::string>& sections) const {
  if (sections.empty()) return {};
  const Parts& p = *parts_;
  const model::MachineSettings& machine = p.machine();
  const controllers::Trajectory& trajectory = p.motion->trajectory;
  const engine::ProgramPath& path = p.program->path;
  const double period = machine.nc.periods.seconds(p.scenario.record_period);
  std::map<std::string, std::vector<Eigen::Vector3d>> positions;
  std::vector<std::vector<Eigen::Vector3d>*> of_section;  // by index; nullptr: not asked for
  for (const std::string& name : path.sections()) {
    of_section.push_back(sections.contains(name) ? &positions[name] : nullptr);
  }
  controllers::Trajectory::Cursor cursor{};
  const engine::ProgramPath::Indices pieces = path.pieces_of(*p.motion->moves);
  for (std::size_t n = 0; static_cast<double>(n) * period <= trajectory.duration(); ++n) {
    const auto now = trajectory.at(static_cast<double>(n) * period, cursor);
    const std::size_t piece = pieces[now.move];
    const engine::ProgramPath::Piece at = path.piece(piece);
    std::vector<Eigen::Vector3d>* out = of_section[static_cast<std::size_t>(at.section)];
    if (at.rapid || out == nullptr) continue;
    const Joints Q_prog = path.joints(piece, now.s, machine.chain.layout, now.Q_ref);
    out->push_back(plant::forward(machine.chain, Q_prog, p.program->tips.at(at.tool_offset)).p_WT);
  }
  return positions;
}

std::vector<Fault> PreparedCase::circular_faults(PreparationCache* cache) const {
  const Parts& p = *parts_;
  const std::set<std::string> names = circular_section_names(p.scenario);
  if (names.empty()) return {};
  PreparationCache own;
  system::MemoKey key;
  key.add_shared(p.program.get());
  key.add_shared(p.motion.get());
  add(key, p.machine().chain);
  key.add(p.machine().nc.periods.seconds(p.scenario.record_period));
  for (const std::string& name : names) key.add(name);
  const auto look = [&] {
    SectionsOfMotion out{p.program, p.motion, {}};
    for (const auto& [name, positions] : nominal_positions(names)) {
      out.sections.emplace(name, circular_section(positions));
    }
    return out;
  };
  return preparation::circular_faults(
      p.scenario, (cache != nullptr ? *cache : own).circles.get(key, look)->sections);
}

}  // namespace servomill::sim::preparation

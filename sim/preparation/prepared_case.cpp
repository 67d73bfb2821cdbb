#include "sim/preparation/prepared_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "controllers/conversational/conversational.h"
#include "controllers/gcode/interpreter.h"
#include "controllers/path/slowed_motion.h"
#include "controllers/path/travel.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/nominal_part.h"
#include "sim/input/subroutine_files.h"
#include "sim/preparation/case_faults.h"
#include "sim/preparation/estimate.h"
#include "sim/preparation/plan_cutting.h"
#include "sim/preparation/preparation_cache.h"
#include "sim/preparation/rewritten_text.h"
#include "sim/preparation/stability_check.h"
#include "sim/run/case_notes.h"
#include "strategies/gcode.h"

namespace servomill::sim {
namespace {

using SharedMesh = std::shared_ptr<const TriangleMesh>;
using SharedModel = std::shared_ptr<const plant::VolumetricModel>;
using SharedProgram = std::shared_ptr<const InterpretedProgram>;
using SharedStrategy = std::shared_ptr<const strategies::Strategy>;
using SharedCutting = std::shared_ptr<const PlannedCutting>;
using SharedMotion = std::shared_ptr<const PlannedMotion>;

controllers::ProgramText text_of(const ProgramSpec& program) {
  return controllers::ProgramText::of_shared_text(program.shared_text, program.file);
}

AxisWords machine_start(const Scenario& scenario, const CaseSpec& spec) {
  return scenario.program.start + scenario.program.work_offset + spec.work_offset;
}

controllers::ProgramSetup setup_of(const Scenario& scenario, const CaseSpec& spec) {
  controllers::ProgramSetup setup;
  setup.parameters = scenario.program.parameters;
  setup.work_offset[0] = scenario.program.work_offset + spec.work_offset;
  setup.tools = scenario.program.tools;
  setup.reader = scenario.program.reader;
  setup.decimal_point = scenario.program.decimal_point;
  setup.feed = scenario.program.first_feed;
  setup.start = machine_start(scenario, spec);
  setup.machine = tool_centre_point(scenario.machine_of(spec));
  setup.subroutine_file = [texts = scenario.program.subroutines, file = scenario.program.file](
                              const std::string& name) -> std::optional<controllers::ProgramText> {
    const auto found = texts.find(name);
    if (found == texts.end()) return std::nullopt;
    return controllers::ProgramText::of_text(found->second, subroutine_file(file, name));
  };
  return setup;
}

// Title of a rewritten program.
std::string header_of(const Scenario& scenario, const CaseSpec& spec) {
  return fmt::format("{}, case {}", scenario.title, spec.name);
}

// Where the key stands that a strategy's complaint names first; the strategy if it is not given.
Place place_in(const StrategySpec& spec, const std::string& complaint) {
  Place place = spec.place;
  std::size_t first = std::string::npos;
  for (const auto& [key, at] : spec.key_places) {
    const std::size_t found = complaint.find(key);
    if (found >= first) continue;
    first = found;
    place = at;
  }
  return place;
}

const plant::ErrorModel& errors_of(const Scenario& scenario, const std::string& model) {
  static const plant::ErrorModel kNone;
  const auto found = scenario.errors.find(model);
  return found == scenario.errors.end() ? kNone : found->second;
}

void add(MemoKey& key, const StrategySpec& spec) {
  key.add(spec.entry->name);
  key.add(spec.sign);
  for (const ParameterSpec& parameter : spec.entry->parameters) {
    key.add(spec.parameters.is_word(parameter.name));
    if (spec.parameters.is_word(parameter.name)) {
      key.add(spec.parameters.word(parameter.name));
    } else {
      key.add(spec.parameters.number(parameter.name));
    }
  }
}

void add(MemoKey& key, const plant::Stock& stock) {
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

void add(MemoKey& key, const std::map<int, plant::Cutter>& cutters) {
  key.add(cutters.size());
  for (const auto& [number, cutter] : cutters) {
    const auto& [radius, corner_radius, length, teeth, helix] = cutter;
    key.add(number);
    key.add(teeth);
    for (const double value : {radius, corner_radius, length, helix}) key.add(value);
  }
}

controllers::PathOptions path_options(const Scenario& scenario, const MachineSettings& machine) {
  controllers::PathOptions options;
  options.tolerance = machine.nc.path_tolerance;
  options.rotary_tolerance = machine.nc.rotary_tolerance;
  options.feed_override = scenario.program.feed_override;
  options.block_time = machine.nc.block_time;
  options.tolerance_share = machine.nc.tolerance_share;
  return options;
}

// One case, step by step; every step asks the cache first.
class Preparation {
 public:
  Preparation(const Scenario& scenario, const CaseSpec& spec, PreparationCache& cache)
      : scenario_(scenario),
        spec_(spec),
        machine_(scenario.machine_of(spec)),
        start_(machine_.chain.layout.joints(machine_start(scenario, spec))),
        cache_(cache) {}

  SharedProgram program() const {
    const controllers::ProgramSetup setup = setup_of(scenario_, spec_);
    MemoKey key;
    const auto shared = cache_.texts.shared(scenario_.program.shared_text);
    key.add_shared(shared.get());
    for (const auto& [name, text] : scenario_.program.subroutines) {
      key.add(name);
      key.add(text);
    }
    add(key, setup);
    return cache_.programs.get(key, [&] {
      std::vector<Fault> warnings;
      MoveList moves = read_program(scenario_, spec_, &warnings);
      refuse_unnumbered_tools(moves, scenario_.program.file);
      InterpretedProgram out(std::move(moves), std::move(warnings), setup);
      out.text = shared;
      return out;
    });
  }

  // Way over feed, s: no plan is faster.
  double least_time(const InterpretedProgram& program) const {
    return controllers::least_time(program.moves, machine_.chain.layout.words(start_),
                                   path_options(scenario_, machine_));
  }

  SharedModel model(const std::string& name) const {
    const plant::ErrorModel& errors = errors_of(scenario_, name);
    MemoKey key;
    add(key, machine_.chain);
    add(key, errors);
    return cache_.models.get(key, [&] { return plant::VolumetricModel(machine_.chain, errors); });
  }

  SharedStrategy strategy(const StrategySpec& spec, const Eigen::Vector3d& tip) const {
    const auto gain = [&](std::size_t j) {
      return spec.entry->reads_gains ? machine_.nc.cascade[j].Kv
                                     : std::numeric_limits<double>::quiet_NaN();
    };
    Joints Kv;
    Kv << gain(0), gain(1), gain(2), gain(3), gain(4);
    const Joints shift = machine_.chain.layout.joints(spec_.work_offset);
    MemoKey key;
    add(key, spec);
    add(key, machine_.chain);
    add(key, errors_of(scenario_, spec.model));
    key.add(tip);
    key.add(machine_.nc.lower);
    key.add(machine_.nc.upper);
    key.add(start_);
    key.add(shift);
    key.add(Kv);
    return cache_.strategies.get(key, [&]() -> SharedStrategy {
      const strategies::Belief belief = {machine_.chain.layout,
                                         *model(spec.model),
                                         tip,
                                         machine_.nc.lower,
                                         machine_.nc.upper,
                                         start_,
                                         shift,
                                         Kv};
      try {
        return spec.entry->make(spec.parameters, spec.sign, belief);
      } catch (const InputError& error) {  // a strategy knows what is wrong, not where it stands
        const std::string& why = error.faults().front().message;
        throw InputError(place_in(spec, why), fmt::format("case {}: strategy {}: {}", spec_.name,
                                                          spec.entry->name, why));
      }
    });
  }

  // A rewritten program is G-code for LinuxCNC, whatever it was before.
  controllers::ProgramSetup setup_of_rewritten() const {
    controllers::ProgramSetup setup = controllers::conversational::gcode_setup(
        text_of(scenario_.program), setup_of(scenario_, spec_));
    setup.reader = controllers::Reader::linuxcnc;
    return setup;
  }

  // Tells where a strategy that corrects tip and tool axis leaves much of them.
  std::shared_ptr<const RewrittenProgram> rewritten(const SharedMoves& moves,
                                                    const SharedStrategy& strategy) const {
    MemoKey key;
    key.add_shared(moves.get());
    key.add_shared(strategy.get());
    key.add(header_of(scenario_, spec_));
    add(key, setup_of(scenario_, spec_));
    add(key, scenario_.machine.chain.layout);
    return cache_.rewritten.get(key, [&] {
      RewrittenText written =
          through_text(rewrite(*strategy, moves->all()),
                       {scenario_.program.file, spec_.name, header_of(scenario_, spec_),
                        scenario_.machine.chain.layout, setup_of_rewritten()});
      return RewrittenProgram{moves, strategy, std::move(written.moves), std::move(written.text)};
    });
  }

  // What the linear axes do for the tip.
  controllers::TipMotions tip_motions(const MoveList& moves, const InterpretedProgram& program,
                                      const controllers::JointLimits& limits,
                                      const controllers::PathOptions& options) const {
    if (program.first_tip_move() == nullptr) return {};
    return controllers::tip_motions(moves, *tool_centre_point(machine_), program.tips, start_,
                                    limits, options, scenario_.program.file);
  }

  // A strategy knows the line that it cannot rewrite, not the file.
  std::vector<Move> rewrite(const strategies::Strategy& strategy,
                            const std::vector<Move>& moves) const {
    try {
      return strategy.rewrite(moves);
    } catch (const InputError& error) {
      const Fault& fault = error.faults().front();
      throw InputError({scenario_.program.file, fault.place.line, 0},
                       fmt::format("case {}: {}", spec_.name, fault.message));
    }
  }

  SharedMotion motion(const SharedMoves& moves, const InterpretedProgram& program) const {
    const controllers::JointLimits limits = {machine_.nc.v_max, machine_.nc.a_max,
                                             machine_.nc.j_max};
    const controllers::PathOptions options = path_options(scenario_, machine_);
    MemoKey key;
    key.add_shared(moves.get());
    add(key, machine_.chain.layout);
    if (program.first_tip_move() != nullptr) add(key, machine_.chain);
    key.add(start_);
    key.add(machine_.nc.lower);
    key.add(machine_.nc.upper);
    add(key, limits);
    add(key, options);
    return cache_.motions.get(key, [&] {
      controllers::TipMotions tip = tip_motions(*moves, program, limits, options);
      auto faults =
          controllers::travel_faults(*moves, machine_.chain.layout, start_, machine_.nc.lower,
                                     machine_.nc.upper, scenario_.program.file, tip);
      if (!faults.empty()) throw InputError(std::move(faults));
      if (const auto slowed = controllers::slowed_inverse_time(*moves, machine_.chain.layout,
                                                               start_, limits, options)) {
        tip.slowed.push_back(*slowed);
      }
      double blocks = 0.0;
      for (const Move& move : *moves) blocks += is_motion(move.kind) ? 1.0 : 0.0;
      return PlannedMotion{
          moves, controllers::plan(*moves, machine_.chain.layout, start_, limits, options, tip),
          blocks, std::move(tip.slowed)};
    });
  }

  // The force of the cut along the original program; nullptr: this case runs in air.
  SharedCutting cutting(const SharedProgram& program) const {
    if (!spec_.cutting) return nullptr;
    const CuttingPlanInputs inputs = {program,
                                      machine_.chain,
                                      start_,
                                      scenario_.program.work_offset + spec_.work_offset,
                                      scenario_.stock,
                                      scenario_.program.cutters,
                                      scenario_.cutting->coefficients,
                                      scenario_.program.file,
                                      scenario_.cutting->place};
    MemoKey key;
    key.add_shared(program.get());
    add(key, machine_.chain);
    key.add(start_);
    key.add(inputs.work_offset);
    add(key, inputs.stock);
    add(key, inputs.cutters);
    for (const plant::NamedCoefficient& K : plant::kCuttingCoefficients) {
      key.add(inputs.coefficients.*K.member);
    }
    return cache_.cuttings.get(key, [&] { return plan_cutting(inputs); });
  }

  // The largest distance of a nominal point from the part.
  double distance_of_plan() const {
    if (!scenario_.part) return 0.0;
    const SharedMesh& mesh = scenario_.part->mesh;
    MemoKey key;
    key.add_shared(mesh.get());
    for (const ProbeSpec& probe : scenario_.probes) {
      for (const plant::ProbeTarget& target : probe.feature.targets) key.add(target.point);
    }
    return cache_.plan_distances
        .get(key,
             [&] {
               return PlanDistance{mesh, largest_distance(scenario_.probes, *mesh)};
             })
        ->distance;
  }

  const Joints& start() const { return start_; }

 private:
  const Scenario& scenario_;
  const CaseSpec& spec_;
  const MachineSettings& machine_;
  Joints start_;
  PreparationCache& cache_;
};

}  // namespace

struct PreparedCase::Parts {
  const Scenario& scenario;
  const CaseSpec& spec;
  SharedProgram program;
  std::vector<SharedStrategy> strategies;
  std::shared_ptr<const RewrittenProgram> rewritten;  // nullptr: the original program runs
  SharedMotion motion;
  SharedModel truth, imposed;
  SharedCutting cutting;
  const MachineSettings& machine() const { return scenario.machine_of(spec); }
  NotedCase noted() const { return {scenario, spec, *program, *motion, cutting.get(), strategies}; }
  Joints machine_start;
  std::optional<ThinningLimits> thinning = {};  // of its recording
  double distance_of_plan = 0.0;                // m, of nominal points from the part
};

PreparedCase::PreparedCase(const Scenario& scenario, const CaseSpec& spec, PreparationCache* cache)
    : parts_(new Parts{scenario, spec, {}, {}, {}, {}, {}, {}, {}, Joints::Zero()}) {
  PreparationCache own;
  const Preparation prepare(scenario, spec, cache != nullptr ? *cache : own);
  Parts& parts = *parts_;
  parts.program = prepare.program();
  parts.machine_start = prepare.start();
  parts.distance_of_plan = prepare.distance_of_plan();
  if (parts.program->path.size() == 0) throw InputError({scenario.program.file}, "moves no axis");
  refuse_absent_axes(*parts.program, scenario);
  refuse_standing_spindle(*parts.program, scenario);
  refuse_turned_tip(*parts.program, scenario, spec);
  const double least_time = prepare.least_time(*parts.program);
  refuse_endless(scenario, least_time);
  // planning takes memory and time for every second of motion
  const std::vector<double> motions(scenario.cases.size(), least_time);
  refuse_too_large(scenario, estimate(scenario, motions, 0));
  refuse_start_outside(scenario, parts.machine(), prepare.start());

  // the strategies, each of which may rewrite what the one before left
  SharedMoves moves(parts.program, &parts.program->moves);
  for (const StrategySpec& strategy : spec.strategies) {
    parts.strategies.push_back(prepare.strategy(strategy, parts.program->first_tip));
    refuse_undeclared_feedback(strategy, *parts.strategies.back());
    refuse_unread_scale(strategy, *parts.strategies.back(), parts.machine(), spec.name);
    if (!parts.strategies.back()->rewrites()) continue;
    refuse_tip_moves(strategy, *parts.strategies.back(), *parts.program, scenario.program.file,
                     spec.name);
    try {
      parts.rewritten = prepare.rewritten(moves, parts.strategies.back());
    } catch (const strategies::TooManyBlocks& error) {
      throw InputError(strategy.place, fmt::format("case {}: strategy {}: {}", spec.name,
                                                   strategy.entry->name, error.what()));
    }
    moves = {parts.rewritten, &parts.rewritten->moves};
  }

  // what the machine can do
  parts.motion = prepare.motion(moves, *parts.program);
  refuse_endless(scenario, parts.motion->trajectory.duration());
  parts.truth = prepare.model(spec.truth.value_or(scenario.truth));
  if (!scenario.imposed.empty()) parts.imposed = prepare.model(scenario.imposed);
  parts.cutting = prepare.cutting(parts.program);
}

void PreparedCase::thin(double bytes) {
  parts_->thinning = {.bytes = bytes,
                      .keep_all = sections_kept_whole(parts_->scenario, sections())};
}

double PreparedCase::duration() const { return parts_->motion->trajectory.duration(); }

PreparedCase::~PreparedCase() = default;
PreparedCase::PreparedCase(PreparedCase&&) noexcept = default;

CaseInputs PreparedCase::inputs(const std::string& scratch_folder) const {
  const Parts& p = *parts_;
  FeedbackHardware hardware = p.scenario.hardware;
  hardware.connected = p.spec.feedback_hardware;
  CaseInputs inputs{p.machine(),
                    *p.truth,
                    p.imposed.get(),
                    p.motion->trajectory,
                    p.program->path,
                    p.program->tips,
                    p.spec.servo,
                    hardware,
                    {},
                    nullptr,
                    p.scenario.record_period,
                    p.scenario.settle_time,
                    p.scenario.record.format,
                    {.folder = scratch_folder,
                     .compression = p.scenario.record.compression,
                     .thinning = p.thinning}};
  inputs.pieces = p.program->path.pieces_of(*p.motion->moves);
  if (p.cutting) {
    inputs.cutting = &p.cutting->table;
    inputs.wear = p.spec.wear;
  }
  for (const auto& strategy : p.strategies) {
    if (auto part = strategy->set_point()) inputs.set_points.push_back(std::move(part));
    if (strategy->displaces_feedback()) inputs.feedback = strategy.get();
    if (strategy->rewrites()) inputs.program_displaces_rotary |= strategy->displaces_rotary();
    if (p.scenario.record.uncorrectable && strategy->uncorrectable(p.machine_start)) {
      inputs.recorded_corrections.push_back(strategy.get());
    }
  }
  return inputs;
}

CaseOutput PreparedCase::output(CaseResult result) const {
  const Parts& p = *parts_;
  CaseOutput out;
  out.name = p.spec.name;
  out.result = std::move(result);
  if (p.rewritten) out.program = p.rewritten->text;
  out.duration = p.motion->trajectory.duration();
  out.blocks = p.motion->blocks;
  out.sections = sections();
  out.chain = p.machine().chain;
  out.signal_delay = p.scenario.signal_delay_of(p.spec);
  if (!p.scenario.probes.empty() && out.result.outcome.finished) {
    ProbedPart part =
        probe_part({p.spec.name, out.result.servo, p.program->path, p.scenario.program.cutters,
                    p.program->tips, out.chain, p.scenario.program.work_offset + p.spec.work_offset,
                    p.imposed.get(), p.scenario.stock.empty() ? nullptr : &p.scenario.stock},
                   p.scenario.probes, p.scenario.cmm);
    out.probes = std::move(part.features);
    out.notes = std::move(part.notes);
    if (p.scenario.part) {
      out.part_fit =
          lay_on_nominal(p.spec.name, *p.scenario.part, p.distance_of_plan, out.probes, out.notes);
    }
  }
  for (std::string& note : notes_of_run(p.noted(), out.result.saturations)) {
    out.notes.push_back(std::move(note));
  }
  return out;
}

CaseOutput PreparedCase::run(const StopFlag& stop, std::atomic<float>& progress,
                             const std::string& scratch_folder) const {
  CaseInputs given = inputs(scratch_folder);
  CaseOutput out = output(simulate(given, stop, progress));
  const NotedCase noted = parts_->noted();
  for (std::string& note : notes_of_uncorrectable(noted)) out.notes.push_back(std::move(note));
  for (std::string& note : notes_of_left_tables(noted)) out.notes.push_back(std::move(note));
  progress = 1.0F;
  return out;
}

const CaseSpec& PreparedCase::spec() const { return parts_->spec; }

const std::vector<std::string>& PreparedCase::sections() const {
  return parts_->program->path.sections();
}

std::map<std::string, std::vector<Eigen::Vector3d>> PreparedCase::nominal_positions(
    const std::set<std::string>& sections) const {
  if (sections.empty()) return {};
  const Parts& p = *parts_;
  const MachineSettings& machine = p.machine();
  const controllers::Trajectory& trajectory = p.motion->trajectory;
  const ProgramPath& path = p.program->path;
  const double period = machine.nc.periods.seconds(p.scenario.record_period);
  std::map<std::string, std::vector<Eigen::Vector3d>> positions;
  std::vector<std::vector<Eigen::Vector3d>*> of_section;  // by index; nullptr: not asked for
  for (const std::string& name : path.sections()) {
    of_section.push_back(sections.contains(name) ? &positions[name] : nullptr);
  }
  controllers::Trajectory::Cursor cursor{};
  const std::vector<std::size_t> pieces = path.pieces_of(*p.motion->moves);
  for (std::size_t n = 0; static_cast<double>(n) * period <= trajectory.duration(); ++n) {
    const auto now = trajectory.at(static_cast<double>(n) * period, cursor);
    const std::size_t piece = pieces[now.move];
    const ProgramPath::Piece at = path.piece(piece);
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
  MemoKey key;
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
  return sim::circular_faults(p.scenario,
                              (cache != nullptr ? *cache : own).circles.get(key, look)->sections);
}

CaseData CaseOutput::data() const {
  return {name,        &result.servo,           sections, duration,
          blocks,      result.outcome.finished, chain,    probes.empty() ? nullptr : &probes,
          signal_delay};
}

std::shared_ptr<const controllers::ToolCentrePoint> tool_centre_point(
    const MachineSettings& machine) {
  return std::make_shared<const controllers::ToolCentrePoint>(
      machine.chain, machine.nc.lower, machine.nc.upper,
      controllers::kGreatCircleShare * machine.nc.rotary_tolerance);
}

MoveList read_program(const Scenario& scenario, const CaseSpec& spec,
                      std::vector<Fault>* warnings) {
  const ProgramSpec& program = scenario.program;
  try {
    controllers::Interpreter interpreter(text_of(program), setup_of(scenario, spec));
    MoveList moves = interpreter.rest_held();
    if (warnings != nullptr) {
      warnings->insert(warnings->end(), interpreter.warnings().begin(),
                       interpreter.warnings().end());
    }
    return moves;
  } catch (const InputError&) {  // stopped at the first fault; the user wants all of them
    auto faults = controllers::check_program(text_of(program), setup_of(scenario, spec));
    if (faults.empty()) throw;
    throw InputError(std::move(faults));
  }
}

std::vector<PreparedCase> prepare_cases(const Scenario& scenario, PreparationCache* cache) {
  PreparationCache own;  // the cases of one scenario share much, too
  if (cache == nullptr) cache = &own;
  const auto reading_delay = [&](const CaseSpec& spec) {
    return scenario.machine.scale_delay +
           (spec.feedback_hardware ? scenario.hardware.signal_delay : 0);
  };
  Tick longest = scenario.machine.scale_delay;
  for (const CaseSpec& spec : scenario.cases) {
    if (!spec.machine) longest = std::max(longest, reading_delay(spec));
  }
  check_stability(scenario.machine, longest, cache);
  std::vector<PreparedCase> prepared;
  CaseFaults faults;
  for (const CaseSpec& spec : scenario.cases) {
    try {
      if (spec.machine) check_stability(*spec.machine, reading_delay(spec), cache);
      prepared.emplace_back(scenario, spec, cache);
    } catch (const InputError& error) {
      faults.add(spec.name, error);
    }
  }
  faults.report(scenario.cases.size());
  const RunEstimate takes = estimate(scenario, prepared, 0);
  refuse_too_large(scenario, takes);
  for (PreparedCase& one : prepared) {
    if (takes.is_thinned) one.thin(takes.file / static_cast<double>(prepared.size()));
  }
  refuse_absent_sections(scenario, prepared.front().sections());
  auto faults_of_circles = prepared.front().circular_faults(cache);
  if (!faults_of_circles.empty()) throw InputError(std::move(faults_of_circles));
  return prepared;
}

}  // namespace servomill::sim

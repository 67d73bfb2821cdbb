#include "sim/run.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <mutex>
#include <thread>

#include "controllers/gcode/printer.h"
#include "controllers/path/travel.h"
#include "plant/vocabulary/units.h"
#include "sim/circular_sections.h"
#include "sim/frequency/frequency_response.h"
#include "sim/stability.h"

namespace servomill::sim {
namespace {

constexpr auto kProgressPeriod = std::chrono::milliseconds(100);

AxisWords machine_start(const Scenario& scenario, const CaseSpec& spec) {
  return scenario.program.start + scenario.program.work_offset + spec.work_offset;
}

controllers::ProgramSetup setup_of(const Scenario& scenario, const CaseSpec& spec) {
  controllers::ProgramSetup setup;
  setup.parameters = scenario.program.parameters;
  setup.work_offset[0] = scenario.program.work_offset + spec.work_offset;
  setup.tools = scenario.program.tools;
  setup.start = machine_start(scenario, spec);
  return setup;
}

std::map<int, Eigen::Vector3d> tips_of(const std::vector<Move>& moves,
                                       const controllers::ToolTable& tools) {
  std::map<int, Eigen::Vector3d> tips = {{0, Eigen::Vector3d::Zero()}};
  for (const Move& move : moves) {
    if (const auto* tool = tools.find(move.tool_offset)) {
      tips[move.tool_offset] = -tool->offset.head<3>();
    }
  }
  return tips;
}

// The tip of the first tool that the program works with: the one that a strategy believes in.
Eigen::Vector3d first_tip(const std::vector<Move>& moves,
                          const std::map<int, Eigen::Vector3d>& tips) {
  for (const Move& move : moves) {
    if (is_motion(move.kind) && move.tool_offset != 0) return tips.at(move.tool_offset);
  }
  return Eigen::Vector3d::Zero();
}

// The rewritten program is written as text and read like any other; what the text cannot say, the
// place on the original path, is carried over block by block.
std::vector<Move> through_text(const std::vector<Move>& rewritten, const Scenario& scenario,
                               const CaseSpec& spec, std::string& text) {
  const std::string title = fmt::format("{}, case {}", scenario.title, spec.name);
  controllers::PrintOptions options;
  options.axes.clear();
  for (const auto& axis : scenario.machine.chain.layout.axis) {
    if (axis) options.axes += letter(*axis);
  }
  text = controllers::print_program(rewritten, options, title).text;
  std::vector<Move> read = controllers::interpret(
      text, fmt::format("{} as rewritten for case {}", scenario.program.file, spec.name),
      setup_of(scenario, spec));
  auto original = rewritten.begin();
  const auto next_motion = [&] {
    return std::find_if(original, rewritten.end(),
                        [](const Move& move) { return is_motion(move.kind); });
  };
  for (Move& move : read) {
    if (!is_motion(move.kind)) continue;
    original = next_motion();
    if (original == rewritten.end()) throw std::logic_error("a rewritten program gained a block");
    move.line = original->line;
    move.s_begin = original->s_begin;
    move.s_end = original->s_end;
    ++original;
  }
  if (next_motion() != rewritten.end()) throw std::logic_error("a rewritten program lost a block");
  return read;
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

// A displaced scale moves nothing where the motor closes the position loop.
void refuse_unread_scale(const StrategySpec& spec, const MachineSettings& machine,
                         const std::string& case_name) {
  if (spec.entry->name != "feedback") return;
  for (const int j : machine.joints()) {
    const auto& feedback = machine.nc.functions[static_cast<std::size_t>(j)].position_feedback;
    if (j >= kLinearJoints || feedback.kind != controllers::PositionFeedback::motor) continue;
    throw InputError(
        spec.place, fmt::format("case {}: strategy feedback: displaces the scale of axis {}, whose "
                                "position loop reads the motor (position_feedback = \"motor\")",
                                case_name, machine.chain.layout.letter_of(j)));
  }
}

std::unique_ptr<strategies::Strategy> make_strategy(const StrategySpec& spec,
                                                    const Scenario& scenario, const CaseSpec& one,
                                                    const Eigen::Vector3d& tip) {
  const MachineSettings& machine = scenario.machine_of(one);
  const auto model = scenario.errors.find(spec.model);
  const strategies::Belief belief = {
      machine.chain.layout,
      plant::VolumetricModel(machine.chain,
                             model == scenario.errors.end() ? plant::ErrorModel{} : model->second),
      tip,
      machine.nc.lower,
      machine.nc.upper,
      machine.chain.layout.joints(machine_start(scenario, one)),
      {machine.nc.cascade[0].Kv, machine.nc.cascade[1].Kv, machine.nc.cascade[2].Kv}};
  try {
    return spec.entry->make(spec.parameters, spec.sign, belief);
  } catch (const InputError& error) {  // a strategy knows what is wrong, not where it stands
    const std::string& why = error.faults().front().message;
    throw InputError(place_in(spec, why),
                     fmt::format("case {}: strategy {}: {}", one.name, spec.entry->name, why));
  }
}

// The innermost loop that is unstable by itself: its gain is the one to lower.
Fault instability(const MachineSettings& machine, int joint, double radius) {
  const auto j = static_cast<std::size_t>(joint);
  const GainPlaces& places = machine.nc.gain_place[j];
  const controllers::CascadeParams& cascade = machine.nc.cascade[j];
  const controllers::CurrentLoopParams& current = machine.nc.functions[j].current_loop;
  const plant::FeedDriveParams& drive = machine.drives[j];
  const char axis = machine.chain.layout.letter_of(joint);
  const std::string_view watch = "or set nc.check_stability = false to watch it diverge";
  if (drive.has_winding() && !(current.Kp * current.Ti < 2.0 * drive.L)) {
    return {places.winding_bandwidth,
            fmt::format("axis {}: the current loop is unstable with winding.bandwidth = {:.4g} "
                        "rad/s; must be < {:.4g} rad/s at its period, {}",
                        axis, current.Kp / drive.L, 2.0 / current.Ti, watch)};
  }
  if (velocity_spectral_radius(machine, joint) >= 1.0 + 1e-9) {
    return {places.velocity_bandwidth,
            fmt::format("axis {}: the velocity loop is unstable with velocity_bandwidth = {:.4g} "
                        "rad/s over its current loop and filters; lower it or make those faster, "
                        "{}",
                        axis, cascade.Kp / cascade.J, watch)};
  }
  return {places.Kv,
          fmt::format("axis {}: the servo loop is unstable with Kv = {:.4g} 1/s over a stable "
                      "velocity loop of {:.4g} rad/s (grows by a factor {:.6g} each period); lower "
                      "Kv or quicken the velocity loop, {}",
                      axis, cascade.Kv, cascade.Kp / cascade.J, radius, watch)};
}

void check_stability(const MachineSettings& machine, Tick reading_delay) {
  if (!machine.nc.check_stability) return;
  std::vector<Fault> faults;
  for (int j = 0; j < kJoints; ++j) {
    if (!machine.chain.layout.has(j)) continue;
    const double radius = spectral_radius(machine, j, reading_delay);
    if (radius < 1.0 + 1e-9) continue;
    faults.push_back(instability(machine, j, radius));
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

// Words of axes that the machine lacks would have no effect.
void refuse_absent_axes(const std::vector<Move>& moves, const Scenario& scenario,
                        const AxisWords& start) {
  std::vector<Fault> faults;
  for (const Axis axis : kAllAxes) {
    if (scenario.machine.chain.layout.joint_of(axis)) continue;
    const auto moved = std::find_if(moves.begin(), moves.end(), [&](const Move& move) {
      return is_motion(move.kind) && move.end_machine[index_of(axis)] != start[index_of(axis)];
    });
    if (moved == moves.end()) continue;
    faults.push_back({{scenario.program.file, moved->line},
                      fmt::format("moves {0}; the machine has no axis {0}", letter(axis))});
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

void refuse_start_outside(const Scenario& scenario, const MachineSettings& machine,
                          const Joints& start) {
  std::vector<Fault> faults;
  for (int j = 0; j < kJoints; ++j) {
    if (!machine.chain.layout.has(j)) continue;
    if (start[j] >= machine.nc.lower[j] && start[j] <= machine.nc.upper[j]) continue;
    const bool linear = j < kLinearJoints;
    const double unit = linear ? mm : deg;
    faults.push_back(
        {scenario.program.start_place,
         fmt::format("program.start: {} = {:.4f} {} with all work offsets, outside the travel; "
                     "must be >= {:.4f} and <= {:.4f}",
                     machine.chain.layout.letter_of(j), start[j] / unit, linear ? "mm" : "deg",
                     machine.nc.lower[j] / unit, machine.nc.upper[j] / unit)});
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

// A slip of the unit can make a program last for years.
void refuse_endless(const Scenario& scenario, double duration) {
  constexpr double kMostSamples = 1e8;  // of some 500 bytes: more than most machines hold
  const double period = scenario.machine.nc.periods.seconds(scenario.record_period);
  const double samples = (duration + scenario.settle_time) / period;
  if (samples <= kMostSamples) return;
  throw InputError({scenario.program.file},
                   fmt::format("takes {:.3g} s: {:.3g} samples at record.period_ms = {:g}; must be "
                               "<= {:g}; check feeds, feed_override and the limits of the axes",
                               duration, samples, period / ms, kMostSamples));
}

// Sections that quantities name, among those that the program has.
void refuse_absent_sections(const Scenario& scenario, const std::vector<std::string>& sections) {
  std::vector<std::string_view> known;
  for (const std::string& name : sections) {
    if (!name.empty()) known.push_back(name);
  }
  std::vector<Fault> faults;
  for (const QuantitySpec& quantity : scenario.quantities) {
    for (const std::string& name : quantity.sections) {
      if (std::find(sections.begin(), sections.end(), name) != sections.end()) continue;
      const std::string near = did_you_mean(name, known);
      faults.push_back(
          {quantity.sections_place,
           fmt::format("{} has no section '{}'{}", scenario.program.file, name,
                       !near.empty()   ? near
                       : known.empty() ? "; a comment (MSG, NAME) begins one"
                                       : fmt::format("; there are: {}", fmt::join(known, ", ")))});
    }
  }
  if (!faults.empty()) throw InputError(std::move(faults));
}

// Faults of several cases, each said once; with the case if not all cases have it.
class CaseFaults {
 public:
  void add(const std::string& case_name, const InputError& error) {
    for (const Fault& fault : error.faults()) {
      const auto same = std::find_if(found_.begin(), found_.end(), [&](const Found& other) {
        return other.fault.place == fault.place && other.fault.message == fault.message;
      });
      if (same == found_.end()) {
        found_.push_back({fault, {case_name}});
      } else {
        same->cases.push_back(case_name);
      }
    }
  }
  void report(std::size_t cases) {
    if (found_.empty()) return;
    std::vector<Fault> faults;
    for (Found& one : found_) {
      const std::string who = fmt::format("case {}: ", fmt::join(one.cases, ", "));
      if (one.cases.size() < cases && !one.fault.message.starts_with(who)) {
        one.fault.message = who + one.fault.message;
      }
      faults.push_back(std::move(one.fault));
    }
    throw InputError(std::move(faults));
  }

 private:
  struct Found {
    Fault fault;
    std::vector<std::string> cases;
  };
  std::vector<Found> found_;
};

controllers::PathOptions path_options(const Scenario& scenario, const MachineSettings& machine) {
  controllers::PathOptions options;
  options.tolerance = machine.nc.path_tolerance;
  options.rotary_tolerance = machine.nc.rotary_tolerance;
  options.feed_override = scenario.program.feed_override;
  return options;
}

}  // namespace

struct PreparedCase::Parts {
  const Scenario& scenario;
  const CaseSpec& spec;
  std::vector<std::unique_ptr<strategies::Strategy>> strategies;
  std::map<int, Eigen::Vector3d> tips;
  std::unique_ptr<plant::VolumetricModel> truth, imposed;
  std::unique_ptr<ProgramPath> path;
  std::unique_ptr<controllers::Trajectory> trajectory;
  std::string program;
  double blocks = 0.0;
};

PreparedCase::PreparedCase(const Scenario& scenario, const CaseSpec& spec)
    : parts_(new Parts{scenario, spec, {}, {}, {}, {}, {}, {}, {}, 0.0}) {
  const MachineSettings& machine = scenario.machine_of(spec);
  Parts& parts = *parts_;
  std::vector<Move> moves = read_program(scenario, spec);
  parts.tips = tips_of(moves, scenario.program.tools);
  parts.path = std::make_unique<ProgramPath>(moves, machine_start(scenario, spec));
  if (parts.path->size() == 0) throw InputError({scenario.program.file}, "moves no axis");
  refuse_absent_axes(moves, scenario, machine_start(scenario, spec));
  refuse_start_outside(scenario, machine,
                       machine.chain.layout.joints(machine_start(scenario, spec)));

  // the strategies, each of which may rewrite what the one before left
  const Eigen::Vector3d tip = first_tip(moves, parts.tips);
  for (const StrategySpec& strategy : spec.strategies) {
    refuse_unread_scale(strategy, machine, spec.name);
    parts.strategies.push_back(make_strategy(strategy, scenario, spec, tip));
    if (!parts.strategies.back()->rewrites()) continue;
    moves = through_text(parts.strategies.back()->rewrite(moves), scenario, spec, parts.program);
  }

  // what the machine can do
  const Joints start = machine.chain.layout.joints(machine_start(scenario, spec));
  auto faults = controllers::travel_faults(moves, machine.chain.layout, start, machine.nc.lower,
                                           machine.nc.upper, scenario.program.file);
  if (!faults.empty()) throw InputError(std::move(faults));
  parts.trajectory = std::make_unique<controllers::Trajectory>(controllers::plan(
      moves, machine.chain.layout, start, {machine.nc.v_max, machine.nc.a_max, machine.nc.j_max},
      path_options(scenario, machine)));
  refuse_endless(scenario, parts.trajectory->duration());
  parts.blocks = static_cast<double>(
      std::count_if(moves.begin(), moves.end(), [](const Move& m) { return is_motion(m.kind); }));

  const auto model = [&](const std::string& name) {
    const auto found = scenario.errors.find(name);
    return std::make_unique<plant::VolumetricModel>(
        machine.chain, found == scenario.errors.end() ? plant::ErrorModel{} : found->second);
  };
  parts.truth = model(scenario.truth);
  if (!scenario.imposed.empty()) parts.imposed = model(scenario.imposed);
}

PreparedCase::~PreparedCase() = default;
PreparedCase::PreparedCase(PreparedCase&&) noexcept = default;

CaseOutput PreparedCase::run(const StopFlag& stop, std::atomic<float>& progress) {
  Parts& p = *parts_;
  const MachineSettings& machine = p.scenario.machine_of(p.spec);
  FeedbackHardware hardware = p.scenario.hardware;
  hardware.connected = p.spec.feedback_hardware;
  CaseInputs inputs{machine,
                    *p.truth,
                    p.imposed.get(),
                    *p.trajectory,
                    *p.path,
                    p.tips,
                    p.spec.servo,
                    hardware,
                    {},
                    nullptr,
                    p.scenario.record_period,
                    p.scenario.settle_time};
  for (const auto& strategy : p.strategies) {
    if (auto part = strategy->set_point()) inputs.set_points.push_back(std::move(part));
    if (auto part = strategy->feedback(machine.nc.periods.seconds(hardware.model_period))) {
      inputs.feedback = std::move(part);
    }
  }
  CaseOutput out;
  out.name = p.spec.name;
  out.result = simulate(inputs, stop, progress);
  out.program = p.program;
  out.duration = p.trajectory->duration();
  out.blocks = p.blocks;
  out.sections = p.path->sections();
  progress = 1.0F;
  return out;
}

const std::vector<std::string>& PreparedCase::sections() const { return parts_->path->sections(); }

std::vector<Eigen::Vector3d> PreparedCase::nominal_positions(const std::string& section) const {
  const Parts& p = *parts_;
  const MachineSettings& machine = p.scenario.machine_of(p.spec);
  const double period = machine.nc.periods.seconds(p.scenario.record_period);
  std::vector<Eigen::Vector3d> positions;
  controllers::Trajectory::Cursor cursor{};
  std::size_t piece = 0;
  for (std::size_t n = 0; static_cast<double>(n) * period <= p.trajectory->duration(); ++n) {
    const auto now = p.trajectory->at(static_cast<double>(n) * period, cursor);
    piece = p.path->piece_at(now.s, piece);
    const ProgramPath::Piece& at = p.path->piece(piece);
    if (at.rapid || p.path->sections()[static_cast<std::size_t>(at.section)] != section) continue;
    Joints Q_prog = machine.chain.layout.joints(p.path->at(piece, now.s));
    Q_prog.tail<kJoints - kLinearJoints>() = now.Q_ref.tail<kJoints - kLinearJoints>();
    positions.push_back(plant::forward(machine.chain, Q_prog, p.tips.at(at.tool_offset)).p_WT);
  }
  return positions;
}

CaseData CaseOutput::data() const {
  return {name, &result.servo, sections, duration, blocks, result.outcome.finished};
}

std::vector<Move> read_program(const Scenario& scenario, const CaseSpec& spec) {
  const ProgramSpec& program = scenario.program;
  try {
    return controllers::interpret(program.text, program.file, setup_of(scenario, spec));
  } catch (const InputError&) {  // stopped at the first fault; the user wants all of them
    auto faults = controllers::check_program(program.text, program.file, setup_of(scenario, spec));
    if (faults.empty()) throw;
    throw InputError(std::move(faults));
  }
}

namespace {

// Everything that can be wrong with the input is found here.
std::vector<PreparedCase> prepare(const Scenario& scenario) {
  const auto reading_delay = [&](const CaseSpec& spec) {
    return scenario.machine.scale_delay +
           (spec.feedback_hardware ? scenario.hardware.signal_delay : 0);
  };
  Tick longest = scenario.machine.scale_delay;
  for (const CaseSpec& spec : scenario.cases) {
    if (!spec.machine) longest = std::max(longest, reading_delay(spec));
  }
  check_stability(scenario.machine, longest);
  std::vector<PreparedCase> prepared;
  CaseFaults faults;
  for (const CaseSpec& spec : scenario.cases) {
    try {
      if (spec.machine) check_stability(*spec.machine, reading_delay(spec));
      prepared.emplace_back(scenario, spec);
    } catch (const InputError& error) {
      faults.add(spec.name, error);
    }
  }
  faults.report(scenario.cases.size());
  refuse_absent_sections(scenario, prepared.front().sections());
  auto faults_of_circles = circular_faults(scenario, [&](const std::string& section) {
    return prepared.front().nominal_positions(section);
  });
  if (!faults_of_circles.empty()) throw InputError(std::move(faults_of_circles));
  return prepared;
}

}  // namespace

void check_scenario(const Scenario& scenario) { prepare(scenario); }

void check_machine(const MachineSettings& machine) {
  check_stability(machine, machine.scale_delay);
}

RunOutput run_scenario(const Scenario& scenario, const RunControl& control) {
  const auto begin = std::chrono::steady_clock::now();
  static const StopFlag kNever = false;
  const StopFlag& stop = control.stop != nullptr ? *control.stop : kNever;
  std::vector<PreparedCase> prepared = prepare(scenario);
  if (control.prepared) control.prepared();

  // cases are independent: which thread runs which makes no difference to the result
  const std::size_t count = prepared.size();
  std::vector<CaseOutput> outputs(count);
  std::vector<std::atomic<float>> progress(count);
  std::vector<std::atomic<bool>> done(count);
  std::vector<std::exception_ptr> failures(count);
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      try {
        outputs[i] = prepared[i].run(stop, progress[i]);
      } catch (...) {
        failures[i] = std::current_exception();
      }
      done[i] = true;
    }
  };
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const unsigned threads = control.threads != 0 ? control.threads : cores;
  std::vector<std::jthread> pool;
  for (unsigned t = 0; t < std::min<std::size_t>(threads, count); ++t) pool.emplace_back(work);

  // should the result not be writable, no further case begins
  struct NoMore {
    std::atomic<std::size_t>& next;
    std::size_t count;
    ~NoMore() { next = count; }
  };
  const NoMore no_more{next, count};
  for (std::size_t i = 0; i < count;) {
    if (!done[i]) {
      std::this_thread::sleep_for(kProgressPeriod);
    } else {
      if (failures[i]) std::rethrow_exception(failures[i]);
      if (control.case_done) control.case_done(outputs[i]);
      ++i;
    }
    if (control.progress) {
      double sum = 0.0;
      for (const auto& share : progress) sum += share;
      control.progress(sum / static_cast<double>(count));
    }
  }
  pool.clear();

  RunOutput out;
  std::vector<CaseData> data;
  for (const CaseOutput& output : outputs) data.push_back(output.data());
  out.comparison = compare(scenario.quantities, data);
  out.cases = std::move(outputs);
  out.wall_time = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

}  // namespace servomill::sim

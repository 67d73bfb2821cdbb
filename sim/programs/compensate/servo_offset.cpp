#include "sim/programs/compensate/servo_offset.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "controllers/gcode/program_setup.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/comparison_row.h"
#include "sim/input/machine_description.h"
#include "sim/input/scenario_source.h"
#include "sim/model/scenario.h"
#include "sim/run/run.h"
#include "sim/run/run_case.h"
#include "sim/run/run_output.h"
#include "strategies/entry.h"
#include "strategies/iterative_learning.h"

namespace servomill::sim::programs {
namespace {

namespace fs = std::filesystem;

constexpr const char* kErrors = "identified";
const std::string kBefore = "as programmed", kAfter = "precompensated";

/// The program as it is written with an offset.
class WrittenProgram final : public strategies::Strategy {
 public:
  WrittenProgram(WrittenMoves written, SharedOffset offset, bool turns)
      : written_(std::move(written)), offset_(std::move(offset)), turns_(turns) {}
  bool rewrites() const override { return true; }
  bool displaces_rotary() const override { return turns_; }
  void rewrite(const MoveRange&, const PutMove& put) const override { written_(offset_, put); }

 private:
  WrittenMoves written_;
  SharedOffset offset_;
  bool turns_;
};

/// Learns the offset of the written program from runs of the model.
class ProgramLearning final : public strategies::LearningStrategy {
 public:
  ProgramLearning(strategies::LearningPlan plan, const JointLayout& layout, WrittenMoves written,
                  strategies::Lesson& lesson)
      : plan_(plan), layout_(layout), written_(std::move(written)), lesson_(lesson) {}

  strategies::TrialSetup trials() const override { return plan_.setup; }
  strategies::Lesson learn(strategies::TrialRuns& runs) const override {
    lesson_ = strategies::learn(plan_, layout_, runs);
    return lesson_;
  }
  std::shared_ptr<const Strategy> with_offset(SharedOffset offset) const override {
    return std::make_shared<WrittenProgram>(written_, std::move(offset), plan_.setup.turns);
  }

 private:
  strategies::LearningPlan plan_;
  JointLayout layout_;
  WrittenMoves written_;
  strategies::Lesson& lesson_;
};

strategies::LearningPlan plan_of(const CompensateRequest& request) {
  constexpr int kRuns = 8;
  strategies::LearningPlan plan;
  plan.setup.as_program = true;
  plan.setup.turns = request.axes == strategies::DisplacedAxes::all;
  plan.setup.sigma_0 = std::sin(1.0 * deg);  // the default of the strategies
  plan.setup.cutoff = plan.filter.cutoff = request.cutoff;
  plan.setup.runs = kRuns;
  plan.tolerance = request.tolerance;
  return plan;
}

strategies::Entry entry_of(const strategies::LearningPlan& plan, const JointLayout& layout,
                           const WrittenMoves& written, strategies::Lesson& lesson) {
  strategies::Entry entry;
  entry.name = "precompensation";
  entry.summary = "the program that compensate writes";
  entry.make = [=, &lesson](const Parameters&, strategies::Action,
                            const strategies::IdentifiedMachine&) {
    return std::make_unique<ProgramLearning>(plan, layout, written, lesson);
  };
  entry.once = entry.corrects_following = entry.runs_program = true;
  entry.imposes = false;
  return entry;
}

// Refuses settings of the control that the model does not have.
void refuse_unmodelled(const CompensateRequest& request, const controllers::ProgramSetup& setup) {
  const auto refuse = [](const char* option, const char* why) {
    throw InputError({option}, fmt::format("cannot be used with --servo: {}", why));
  };
  if (request.smoothing > 0.0) {
    refuse("--smoothing", "the model does not know the smoothing of other controls");
  }
  if (request.lists_uncertainty) {
    refuse("--point-uncertainty", "it is of geometric errors alone");
  }
  if (!request.inputs.parameter_file.empty()) {
    refuse("--parameter-file", "give the place of G54 by --work-offset");
  }
  if (!request.inputs.subroutine_folders.empty()) {
    refuse("--subs", "put the subroutines next to the program");
  }
  if (!request.inputs.additional_offsets.empty()) {
    refuse("--additional-offset", "the model runs programs in G54");
  }
  if (request.inputs.block_delete) refuse("--block-delete", "the model runs every block");
  const bool others = std::any_of(setup.work_offset.begin() + 1, setup.work_offset.end(),
                                  [](const AxisWords& one) { return !one.isZero(0.0); });
  const bool turned = std::any_of(setup.work_rotation.begin(), setup.work_rotation.end(),
                                  [](double one) { return one != 0.0; });
  if (others || turned) refuse("--work-offset", "the model runs programs in G54, not rotated");
  if (request.start.empty()) {
    throw InputError({"--servo"},
                     "needs --start X=...,Y=...: the model runs the program from there");
  }
}

std::string kinematics_of(const plant::MachineChain& chain) {
  std::string out;
  for (const plant::ChainAxis& axis : chain.axes) out += letter(axis.axis);
  return out;
}

// A model of another machine corrects nothing on this one.
void refuse_other_machine(const std::string& file, const input::MachineDescription& model,
                          const model::MachineSettings& machine) {
  if (!model.has_drives) {
    throw InputError({file},
                     "has no drives: --servo needs an identified model of servo, friction "
                     "and structure, such as servomill identify writes");
  }
  const model::MachineSettings& known = *model.machine;
  const auto refuse = [&](const std::string& why) {
    throw InputError({file}, "is the model of another machine: " + why);
  };
  if (known.name != machine.name) {
    refuse(fmt::format("'{}', where --machine is '{}'", known.name, machine.name));
  }
  if (kinematics_of(known.chain) != kinematics_of(machine.chain)) {
    refuse(fmt::format("its axes are {}, those of --machine {}", kinematics_of(known.chain),
                       kinematics_of(machine.chain)));
  }
  for (const int j : machine.joints()) {
    const model::NcSettings &a = known.nc, &b = machine.nc;
    const bool is_given = std::isfinite(b.lower[j]) && std::isfinite(b.upper[j]);
    if (!is_given || (a.lower[j] == b.lower[j] && a.upper[j] == b.upper[j])) continue;
    refuse(fmt::format("axis {} has another travel", machine.chain.layout.letter_of(j)));
  }
}

std::string quoted(const std::string& path) {
  std::string out = "\"";
  for (const char c : fs::absolute(path).string()) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

// The program on the model, twice: as it is, and as it is written.
model::Scenario scenario_of(const CompensateRequest& request, const plant::ErrorModel& errors,
                            const controllers::ProgramSetup& setup) {
  const std::string text = fmt::format(
      "title = \"servomill compensate\"\nsource = \"none\"\nmachine = {}\n"
      "[program]\nfile = {}\n[[case]]\nname = \"{}\"\n[[case]]\nname = \"{}\"\n"
      "[[quantity]]\nname = \"contour_error\"\nstatistic = \"max\"\n",
      quoted(request.servo_file), quoted(request.program_file), kBefore, kAfter);
  model::Scenario out = input::ScenarioSource("compensate.toml", {}, text).at();
  out.errors = {{kErrors, errors}};
  out.machine_errors = kErrors;
  model::ProgramSpec& program = out.program;
  program.file = request.program_file;
  program.parameters = setup.parameters;
  program.tools = setup.tools;
  program.reader = setup.reader;
  program.decimal_point = setup.decimal_point;
  program.first_feed = setup.feed;
  program.ignored_codes = setup.ignored_codes;
  program.work_offset = setup.work_offset.front();
  program.start = setup.start - program.work_offset;
  program.start_place = {"--start " + request.start};
  return out;
}

ServoFigures figures_of(const run::RunOutput& done, std::size_t number) {
  const run::CaseOutput& one = done.cases[number];
  if (!one.result.outcome.finished) {
    throw InputError({"--servo"}, fmt::format("the run of the program {} stops: {}", one.name,
                                              one.result.outcome.reason));
  }
  ServoFigures out;
  out.duration = one.duration;
  for (const evaluation::ComparisonRow& row : done.comparison) {
    if (row.case_name == one.name) out.contour = row.value * um;
  }
  return out;
}

// At equal arc length, as the model was learnt from.
void take_deviations(const strategies::Lesson& lesson, ServoPrediction& out) {
  const auto take = [](const strategies::TrialFigures& from, ServoFigures& to) {
    to.tip = from.largest;
    to.tip_rms = from.rms;
  };
  take(lesson.trials.front(), out.before);
  take(*std::min_element(lesson.trials.begin(), lesson.trials.end(),
                         [](const auto& x, const auto& y) { return x.rms < y.rms; }),
       out.after);
}

}  // namespace

ServoPrediction predict_servo(const CompensateRequest& request,
                              const model::MachineSettings& machine,
                              const plant::ErrorModel& errors,
                              const controllers::ProgramSetup& setup, const WrittenMoves& written,
                              SharedOffset& offset) {
  refuse_unmodelled(request, setup);
  const input::MachineDescription described = input::read_machine_description(request.servo_file);
  refuse_other_machine(request.servo_file, described, machine);
  strategies::Lesson lesson;
  const strategies::LearningPlan plan = plan_of(request);
  const strategies::Entry entry = entry_of(plan, machine.chain.layout, written, lesson);
  model::Scenario scenario = scenario_of(request, errors, setup);
  model::StrategySpec strategy;
  strategy.entry = &entry;
  strategy.model = kErrors;
  strategy.place = {"--servo"};
  scenario.cases.back().strategies.push_back(std::move(strategy));

  run::RunControl control;
  control.stop = &interrupt_wanted;
  const run::RunOutput done = run::run_scenario(scenario, control);
  throw_if_interrupted();
  ServoPrediction out;
  out.model = request.servo_file;
  out.cutoff = request.cutoff;
  out.runs = static_cast<int>(lesson.trials.size());
  out.before = figures_of(done, 0);
  out.after = figures_of(done, 1);
  take_deviations(lesson, out);
  if (!(out.after.tip_rms < out.before.tip_rms)) {
    throw InputError(
        {"--servo"},
        fmt::format("no offset makes the program better on the model: the tip deviates "
                    "by {:.2f} um rms as programmed, by {:.2f} um with the best of {} "
                    "runs",
                    out.before.tip_rms / um, out.after.tip_rms / um, out.runs));
  }
  offset = lesson.offset;
  return out;
}

}  // namespace servomill::sim::programs

#include "sim/programs/compensate/compensate.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>

#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/parameters.h"
#include "controllers/gcode/request.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/units.h"
#include "sim/input/machine_description.h"
#include "sim/input/read_errors.h"
#include "sim/model/design.h"
#include "sim/programs/canonical_moves.h"
#include "sim/programs/compensate/compensate_report.h"
#include "sim/programs/compensate/dialect_settings.h"
#include "sim/programs/compensate/dialect_writer.h"
#include "sim/programs/compensate/highest_z.h"
#include "sim/programs/compensate/linuxcnc_writer.h"
#include "sim/programs/compensate/point_uncertainty.h"
#include "sim/programs/compensate/program_corrector.h"
#include "sim/programs/compensate/servo_offset.h"
#include "sim/programs/compensate/smoothed_feeds.h"
#include "sim/programs/compensate/step_moves.h"
#include "sim/programs/compensate/work_knowledge.h"
#include "sim/programs/line_stage.h"
#include "sim/programs/verification/verification.h"
#include "sim/system/read_file.h"

namespace servomill::sim::programs {
namespace {

constexpr std::string_view kHeader = "(servomill compensate:";  // of corrected programs

namespace fs = std::filesystem;

using ErrorModels = std::map<std::string, plant::ErrorModel>;

const plant::ErrorModel& model_of(const ErrorModels& models, const CompensateRequest& request,
                                  std::string& name) {
  const std::string& file = request.file_of_errors();
  std::vector<std::string_view> names;
  for (const auto& [key, model] : models) names.push_back(key);
  static const plant::ErrorModel kNone;
  if (names.empty() && !request.servo_file.empty() && request.model.empty()) return kNone;
  if (names.empty()) {
    throw InputError({file},
                     request.error_file.empty()
                         ? "has no error model; add [errors.NAME] or pass a file with --errors"
                         : "has no error model; add one as [errors.NAME]");
  }
  const std::string there_are = fmt::format("known are {}", fmt::join(names, ", "));
  if (request.model.empty() && names.size() > 1) {
    throw InputError({"--model"}, fmt::format("is missing; {}", there_are));
  }
  name = request.model.empty() ? std::string(names.front()) : request.model;
  const auto found = models.find(name);
  if (found != models.end()) return found->second;
  throw InputError({"--model"}, fmt::format("no error model '{}'{}; {}", name,
                                            did_you_mean(name, names), there_are));
}

// So that rounding takes a fiftieth of the tolerance at most.
int decimals_for(double tolerance) {
  constexpr double kShare = 50.0;
  constexpr int kFewest = 3, kMax = 7;
  return std::clamp(static_cast<int>(std::ceil(-std::log10(tolerance / mm / kShare))), kFewest,
                    kMax);
}

WalkOptions walk_options(const CompensateRequest& request, const model::MachineSettings& machine,
                         const controllers::ProgramSetup& setup) {
  constexpr double kLever = 0.1;  // m: what a turn is seen from
  WalkOptions options;
  options.fit.tolerance = request.tolerance;
  options.fit.tolerance_turn = request.tolerance / kLever;
  options.fit.max_block = request.max_block;
  if (request.max_block > 0.0) options.fit.look = std::min(options.fit.look, request.max_block);
  options.is_for_other_control = request.dialect != Dialect::linuxcnc;
  options.corrects_rapids = request.corrects_rapids;
  options.lower = machine.nc.lower;
  options.upper = machine.nc.upper;
  options.start = setup.start;
  options.file = request.program_file;
  return options;
}

std::string header_line(const CompensateRequest& request, const std::string& machine,
                        const std::string& model) {
  std::string out = fmt::format("servomill compensate: {} for {}",
                                fs::path(request.program_file).filename().string(), machine);
  if (!model.empty()) out += ", errors " + model;
  if (request.servo_file.empty()) return out;
  return out + ", servo model " + fs::path(request.servo_file).filename().string();
}

std::unique_ptr<ProgramWriter> writer_of(const CompensateRequest& request,
                                         const input::MachineDescription& described,
                                         const controllers::ProgramSetup& setup,
                                         ProgramCorrector& corrector, Summary& summary) {
  if (request.dialect == Dialect::linuxcnc && request.smoothing > 0.0) {
    throw InputError({"--smoothing"}, "is for other controls; LinuxCNC takes G64 P in the program");
  }
  if (request.dialect != Dialect::linuxcnc) {
    DialectSettings settings = dialect_settings(request, described, setup);
    for (std::size_t i = 0; i < settings.rotary_start.size(); ++i) {
      const Axis axis = kAllAxes[kLinearJoints + i];
      if (corrector.has(axis) && corrector.is_known(axis)) {
        settings.rotary_start[i] = corrector.out()[index_of(axis)];
      }
    }
    return std::make_unique<DialectWriter>(corrector, summary, settings, request.program_file);
  }
  return std::make_unique<LinuxCncWriter>(corrector, summary, decimals_for(request.tolerance));
}

std::string path_line(const CompensateRequest& request, const ProgramWriter& writer) {
  const std::string line =
      fmt::format("path within {:g} um of the corrected one", request.tolerance / um);
  const std::string rounding = writer.rounding();
  return rounding.empty() ? line : fmt::format("{}, positions rounded to {}", line, rounding);
}

// Values of a request before its program is read.
struct Preparation {
  explicit Preparation(const CompensateRequest& request)
      : described(input::read_machine_description(request.machine_file, request.changes)),
        layout(described.machine->chain.layout),
        models(request.error_file.empty()
                   ? described.errors
                   : input::read_error_file(request.error_file,
                                            input::MachineAxes(*described.machine))),
        errors(model_of(models, request, model)),
        correction(described.machine->chain,
                   request.servo_file.empty() ? errors : plant::ErrorModel{}, request.axes),
        known(read_work_knowledge(request, *described.machine)),
        options(walk_options(request, *described.machine, known.setup)) {
    const model::NcSettings& nc = described.machine->nc;
    correction.leave(request.left);
    if (request.servo_file.empty()) {
      known.place_matters = axes_that_matter(correction, nc.lower, nc.upper);
    }
    take_start(request);
    if (!request.servo_file.empty()) follow_model(request);
  }

  void take_start(const CompensateRequest& request) {
    if (request.start.empty()) return;
    const AxisValues start = axis_values("--start", request.start, &layout, false);
    options.start = known.setup.start = start.words;
    options.is_start_known = start.given;
    // programs for other controls retract first
    if (options.is_for_other_control) options.is_start_known[2] = false;
  }

  // The blocks that LinuxCNC runs are those of every dialect.
  void put_moves_with(const CompensateRequest& request, const SharedOffset& offset,
                      const PutMove& put) const {
    Correction along(described.machine->chain, {}, request.axes);
    along.follow(offset);
    along.leave(request.left);
    WalkOptions walk = options;
    walk.is_for_other_control = false;
    walk.is_start_known.fill(true);
    Summary summary;
    ProgramCorrector corrector(walk, known.setup.tools, along, summary);
    StepMoves moves(corrector, put);
    controllers::Interpreter interpreter(controllers::ProgramText::of_file(request.program_file),
                                         known.setup);
    while (const auto block = interpreter.next_block()) {
      throw_if_interrupted();
      moves.write(*block);
    }
  }

  void follow_model(const CompensateRequest& request) {
    SharedOffset offset;
    servo = predict_servo(
        request, *described.machine, errors, known.setup,
        [&](const SharedOffset& one, const PutMove& put) { put_moves_with(request, one, put); },
        offset);
    correction.follow(offset);
  }

  input::MachineDescription described;
  const JointLayout& layout;
  ErrorModels models;
  std::string model;
  const plant::ErrorModel& errors;
  Correction correction;
  WorkKnowledge known;
  WalkOptions options;
  std::optional<ServoPrediction> servo;  // of the model that the correction follows
};

// Reads the written program back and compares it with the original.
VerificationReport verify(const CompensateRequest& request, Preparation& prepared,
                          const std::string& written) {
  const WorkKnowledge& known = prepared.known;
  const WalkOptions& options = prepared.options;
  constexpr double kTurnDecimals = 1e-6 * deg;
  VerificationRequest out;
  out.original_file = request.program_file;
  out.setup = known.setup;
  out.dialect = request.dialect;
  out.layout = prepared.layout;
  out.is_endless = endless_axes(prepared.described);
  out.is_start_known = options.is_start_known;
  const bool is_linuxcnc = request.dialect == Dialect::linuxcnc;
  std::array<bool, controllers::kWorkSystems> is_known{};
  is_known.fill(!known.depends_on_place());
  for (const int system : known.work_systems) is_known[static_cast<std::size_t>(system - 1)] = true;
  out.control = control_setup(known.setup, is_known, options.is_start_known);
  out.without = request.without;
  if (request.dialect == Dialect::heidenhain && request.preset) {
    const auto G54 = out.control.work_offset.front();
    out.control.work_offset.fill(std::nullopt);
    out.control.work_offset[1] = G54;  // the first is active at the start
    out.control.first_preset = *request.preset - 1;
  }
  ComparisonLimits& limits = out.limits;
  limits.tolerance = options.fit.tolerance;
  limits.tolerance_turn = options.fit.tolerance_turn;
  limits.grid =
      is_linuxcnc ? std::pow(10.0, -decimals_for(request.tolerance)) * mm : resolution_of(request);
  limits.grid_turn = is_linuxcnc ? kTurnDecimals : resolution_of(request) / mm * deg;
  limits.corrects_rapids = options.corrects_rapids;
  if (request.dialect == Dialect::heidenhain) limits.time_digit = 1e-3;  // FT has three decimals
  limits.is_linuxcnc = is_linuxcnc;
  limits.retract = retract_of(request, prepared.described);
  return verify_program(written, out, prepared.correction);
}

// Before the work: a slip of the unit makes blocks without end.
void refuse_too_many_blocks(const CompensateRequest& request,
                            const controllers::ProgramSetup& setup) {
  constexpr double kMaxBlocks = 1e7;
  if (!(request.max_block > 0.0)) return;
  double way = 0.0;
  try {
    controllers::Interpreter interpreter(controllers::ProgramText::of_file(request.program_file),
                                         setup);
    while (const Move* move = interpreter.next()) {
      if (is_motion(move->kind) && move->kind != MoveKind::rapid)
        way += move->s_end - move->s_begin;
    }
  } catch (const InputError&) {
    return;  // reported when the program is corrected
  }
  if (way <= kMaxBlocks * request.max_block) return;
  throw InputError({"--max-block"},
                   fmt::format("{:g} um makes {:.2g} blocks of {:.4g} m of feed; must be <= {:g} "
                               "blocks; use a larger value",
                               request.max_block / um, way / request.max_block, way, kMaxBlocks));
}

// Takes what a writer assumes and warns of.
void add_clauses(const ProgramWriter& writer, const std::string& file, Compensated& out) {
  for (std::string& clause : writer.assumptions()) {
    out.warnings.push_back({{file}, "assumes that " + clause});
    out.summary.assumed.push_back(std::move(clause));
  }
  for (std::string& sentence : writer.warnings()) {
    out.warnings.push_back({{file}, std::move(sentence)});
  }
}

void add_to(std::vector<std::string>& lines, const std::vector<std::string>& more) {
  lines.insert(lines.end(), more.begin(), more.end());
}

// Comments at the head of the program.
std::vector<std::string> header_of(const CompensateRequest& request, const Preparation& prepared,
                                   const ProgramWriter& writer, const Summary& summary) {
  std::vector<std::string> header = {
      header_line(request, prepared.described.machine->name, prepared.model)};
  header.push_back(path_line(request, writer));
  add_to(header, unrolled_parts(summary));
  for (const std::string& one : summary.assumed) header.push_back("assumed: " + one);
  for (const std::string& one : writer.warnings()) header.push_back("warning: " + one);
  return header;
}

// Lines of the report and its JSON.
void add_report(const VerificationReport& verified, const JointLayout& layout, Compensated& out) {
  const Summary& summary = out.summary;
  const bool has_uncertainty = out.uncertainty && !out.uncertainty->empty();
  out.report = summary.report(layout);
  if (has_uncertainty) add_to(out.report, out.uncertainty->report());
  out.report.push_back(verified.text());
  add_to(out.report, unrolled_parts(summary));
  for (const std::string& one : summary.assumed) out.report.push_back("assumed: " + one);
  out.json = summary.json(layout, has_uncertainty ? out.uncertainty->json() : "null");
}

// The program that is written would lack them.
void refuse_unread_blocks(const controllers::Interpreter& interpreter,
                          const CompensateRequest& request) {
  if (interpreter.unread_behind() == 0) return;
  throw InputError({request.program_file, interpreter.unread_behind(), 1},
                   "the program ends at this '%', but blocks follow it; remove the '%', or end the "
                   "program with M30 before it");
}

// Corrects block after block.
void write_blocks(const CompensateRequest& request, WorkKnowledge& known,
                  controllers::Interpreter& interpreter, ProgramWriter& writer, HighestZ& highest,
                  std::vector<Fault>& warnings) {
  LineStage lines(request.program_file);
  while (const auto block = interpreter.next_block()) {
    throw_if_interrupted();
    lines.at(block->line);
    if (known.depends_on_place()) highest.look(*block);
    refuse_unknown_system(*block, request, known);
    if (block->text.starts_with(kHeader)) {
      warnings.push_back({{request.program_file, block->line},
                          "this program was corrected before and is now corrected again"});
    }
    writer.write(*block);
  }
  refuse_unread_blocks(interpreter, request);
}

}  // namespace

std::string points_csv(const Compensated& done) { return done.uncertainty->csv(); }

Compensated compensate(const CompensateRequest& request) {
  Preparation prepared(request);
  const model::MachineSettings& machine = *prepared.described.machine;
  const JointLayout& layout = prepared.layout;
  Correction& correction = prepared.correction;
  WorkKnowledge& known = prepared.known;

  refuse_too_many_blocks(request, known.setup);

  Compensated out;
  out.summary.servo = prepared.servo;
  std::optional<SmoothedFeeds> smoothed;
  if (request.smoothing > 0.0) smoothed.emplace(machine, request.smoothing, request.tolerance);
  const std::shared_ptr<PointUncertainty> uncertainty =
      uncertainty_of(request, machine.chain, prepared.model, prepared.errors);
  out.uncertainty = uncertainty;
  ProgramCorrector corrector(prepared.options, known.setup.tools, correction, out.summary,
                             request.records ? &out.record : nullptr,
                             smoothed ? &*smoothed : nullptr, uncertainty.get());
  const auto writer = writer_of(request, prepared.described, known.setup, corrector, out.summary);
  controllers::Interpreter interpreter(controllers::ProgramText::of_file(request.program_file),
                                       known.setup);
  HighestZ highest;
  Stage parts("parts", 2.0, Steps::unlike);  // correction, verification
  write_blocks(request, known, interpreter, *writer, highest, out.warnings);
  parts.advance();
  if (uncertainty) uncertainty->refuse_undetermined(request.file_of_errors(), request.left);

  const std::optional<double> retract = retract_of(request, prepared.described);
  if (prepared.options.is_for_other_control && retract) {
    highest.refuse_above(*retract, request.program_file);
  }

  Summary& summary = out.summary;
  summary.reversal_distance = correction.longest_reversal();
  if (smoothed) {
    smoothed->end_run();
    summary.smoothing = smoothed->text();
  }
  summary.assumed = assumptions(request, known, summary, layout);
  add_clauses(*writer, request.program_file, out);
  out.program = writer->finish(header_of(request, prepared, *writer, summary));

  const VerificationReport verified = verify(request, prepared, out.program);

  add_report(verified, layout, out);
  out.warnings.insert(out.warnings.end(), interpreter.warnings().begin(),
                      interpreter.warnings().end());
  const auto more = warnings_of(request, summary, layout);
  out.warnings.insert(out.warnings.end(), more.begin(), more.end());
  out.machine = machine.name;
  return out;
}

VerificationReport verify_compensated(const CompensateRequest& request,
                                      const std::string& written) {
  Preparation prepared(request);
  return verify(request, prepared, written);
}

}  // namespace servomill::sim::programs

#include "sim/programs/compensate/compensate.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>

#include "controllers/gcode/modal_state.h"
#include "controllers/gcode/parameters.h"
#include "controllers/gcode/request.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/input/read_errors.h"
#include "sim/input/read_machine.h"
#include "sim/model/design.h"
#include "sim/model/scenario.h"
#include "sim/programs/canon.h"
#include "sim/programs/compensate/dialect_writer.h"
#include "sim/programs/compensate/highest_z.h"
#include "sim/programs/compensate/linuxcnc_writer.h"
#include "sim/programs/compensate/smoothed_feeds.h"
#include "sim/programs/compensate/walk.h"
#include "sim/programs/compensate/work_knowledge.h"
#include "sim/programs/verification/verification.h"
#include "sim/system/read_file.h"

namespace servomill::sim {
namespace {

constexpr std::string_view kHeader = "(servomill compensate:";  // of corrected programs

namespace fs = std::filesystem;
using strategies::DisplacedAxes;

constexpr double kReportedTip = 0.1e-6, kReportedAxis = 1e-6;  // m, rad: of less nothing is said

using ErrorModels = std::map<std::string, plant::ErrorModel>;

const plant::ErrorModel& model_of(const ErrorModels& models, const CompensateRequest& request,
                                  std::string& name) {
  const std::string& file = request.error_file.empty() ? request.machine_file : request.error_file;
  std::vector<std::string_view> names;
  for (const auto& [key, model] : models) names.push_back(key);
  if (names.empty()) {
    throw InputError({file}, request.error_file.empty()
                                 ? "has no error model; write one as [errors.NAME] or name a file "
                                   "of them with --errors"
                                 : "has no error model; write one as [errors.NAME]");
  }
  const std::string there_are = fmt::format("there are {}", fmt::join(names, ", "));
  if (request.model.empty() && names.size() > 1) {
    throw InputError({"--model"}, fmt::format("is missing; {}", there_are));
  }
  name = request.model.empty() ? std::string(names.front()) : request.model;
  const auto found = models.find(name);
  if (found != models.end()) return found->second;
  throw InputError({"--model"}, fmt::format("no error model '{}'{}; {}", name,
                                            did_you_mean(name, names), there_are));
}

// Assumptions that the result relies on.
std::vector<std::string> assumptions(const CompensateRequest& request, const WorkKnowledge& known,
                                     const Summary& summary, const JointLayout& layout) {
  std::vector<std::string> out;
  for (const int system : known.work_systems) {
    const WorkSystemPlace place = place_of(known.setup, system);
    const bool is_there = !place.offset.isZero(0.0) || place.rotation != 0.0;
    if (!is_there && system != 1) continue;
    out.push_back(fmt::format(
        "{} lies at {}{}", kWorkSystems[static_cast<std::size_t>(system - 1)],
        words_text(place.offset, layout),
        place.rotation == 0.0 ? "" : fmt::format(", turned by {:g} deg", place.rotation / deg)));
  }
  for (const auto& [number, length] : summary.tools) {
    out.push_back(number == 0  ? fmt::format("no tool is known: length {:g} mm", length / mm)
                  : number < 0 ? fmt::format("tool offset of G43.1: length {:g} mm", length / mm)
                               : fmt::format("tool {}: length {:g} mm", number, length / mm));
  }
  if (!request.start.empty()) out.push_back(fmt::format("the machine starts at {}", request.start));
  return out;
}

std::vector<std::string> unrolled(const Summary& summary) {
  std::vector<std::string> out;
  if (summary.unrolled) out.emplace_back("loops and subroutines are unrolled");
  if (summary.has_expressions) out.emplace_back("expressions became numbers");
  if (summary.has_cycles) out.emplace_back("canned cycles became their moves");
  if (summary.has_cutter_compensation) {
    out.emplace_back("cutter compensation became its moves, for the diameters of the tool table");
  }
  return out;
}

std::vector<Fault> warnings_of(const CompensateRequest& request, const Summary& summary,
                               const JointLayout& layout) {
  std::vector<Fault> out;
  if (summary.outside) {
    out.push_back(
        {{request.program_file, summary.outside->line},
         fmt::format("ends outside the travel of the machine, at {}{}; are the work "
                     "offsets right?",
                     words_text(summary.outside->machine, layout),
                     summary.outside_count == 1
                         ? ""
                         : fmt::format(", as do {} other blocks", summary.outside_count - 1))});
  }
  const bool turns = request.axes == DisplacedAxes::all;
  std::vector<std::string> left;
  if (summary.left.tip > kReportedTip) {
    left.push_back(fmt::format("{:.2f} um of the tip", summary.left.tip / um));
  }
  if (summary.left.axis > kReportedAxis) {
    left.push_back(fmt::format("{:.1f} urad of the tool axis", summary.left.axis / urad));
  }
  if (!left.empty() && summary.most_left) {
    out.push_back({{request.program_file, summary.most_left->line},
                   fmt::format("cannot correct {} here, the most found{}", fmt::join(left, " and "),
                               turns ? "" : "; linear axes do not turn the tool")});
  }
  return out;
}

// So that rounding takes a fiftieth of the tolerance at most.
int decimals_for(double tolerance) {
  constexpr double kShare = 50.0;
  constexpr int kFewest = 3, kMost = 7;
  return std::clamp(static_cast<int>(std::ceil(-std::log10(tolerance / mm / kShare))), kFewest,
                    kMost);
}

WalkOptions walk_options(const CompensateRequest& request, const MachineSettings& machine,
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
  return fmt::format("servomill compensate: {} for {}, errors {}",
                     fs::path(request.program_file).filename().string(), machine, model);
}

// IS-B and the like; Siemens computes in finer steps than anyone measures.
double resolution_of(const CompensateRequest& request) {
  if (request.resolution > 0.0) return request.resolution;
  return request.dialect == Dialect::siemens ? 10e-9 : 1e-6;
}

std::array<bool, 3> endless_axes(const MachineDescription& described) {
  const JointLayout& layout = described.machine.chain.layout;
  std::array<bool, 3> out{};
  for (std::size_t i = 0; i < out.size(); ++i) {
    const std::optional<int> j = layout.joint_of(kAllAxes[kLinearJoints + i]);
    const NcSettings& nc = described.machine.nc;
    out[i] = j && (std::isinf(nc.lower[*j]) || std::isinf(nc.upper[*j]));
  }
  return out;
}

DialectSettings dialect_settings(const CompensateRequest& request,
                                 const MachineDescription& described,
                                 const controllers::ProgramSetup& setup) {
  if (request.corrects_rapids) {
    throw InputError({"--correct-rapids"},
                     "is for LinuxCNC; on other controls a rapid need not follow a line");
  }
  DialectSettings settings;
  settings.dialect = request.dialect;
  settings.name = request.program_name;
  settings.program_number = request.program_number;
  settings.resolution = resolution_of(request);
  settings.preset = request.preset;
  settings.without = request.without;
  if (!request.without.empty() && request.dialect != Dialect::fanuc) {
    throw InputError({"--without"}, "names functions of Fanuc controls; it is for --dialect fanuc");
  }
  for (int system = 1; system <= controllers::kWorkSystems; ++system) {
    settings.work_offset[static_cast<std::size_t>(system - 1)] = place_of(setup, system).offset;
  }
  settings.smoothing = request.smoothing;
  const auto retract = request.retract_Z ? request.retract_Z : described.retract_Z;
  if (!retract) {
    throw InputError({"--retract"},
                     "is missing: programs for other controls retract before and after; --retract "
                     "Z=... in machine coordinates, or axis.Z.retract_mm of the machine file");
  }
  const NcSettings& nc = described.machine.nc;
  if (*retract < nc.lower[2] || *retract > nc.upper[2]) {
    throw InputError({fmt::format("--retract Z={:g}", *retract / mm)},
                     fmt::format("is outside the travel of Z, {:g} ... {:g} mm", nc.lower[2] / mm,
                                 nc.upper[2] / mm));
  }
  settings.retract_Z = *retract;
  if (request.dialect == Dialect::fanuc && request.program_number == 0) {
    throw InputError({"--program-number"},
                     "is missing: Fanuc programs have a number, 1 ... 9999, and the name of the "
                     "file gives none");
  }
  const JointLayout& layout = described.machine.chain.layout;
  settings.axes.clear();
  for (const Axis axis : kAllAxes) {
    if (layout.joint_of(axis)) settings.axes.push_back(axis);
  }
  settings.has_rotary_axes = layout.has(kLinearJoints) || layout.has(kLinearJoints + 1);
  settings.is_endless = endless_axes(described);
  return settings;
}

std::unique_ptr<ProgramWriter> writer_of(const CompensateRequest& request,
                                         const MachineDescription& described,
                                         const controllers::ProgramSetup& setup, Walk& walk,
                                         Summary& summary) {
  if (request.dialect == Dialect::linuxcnc && request.smoothing > 0.0) {
    throw InputError({"--smoothing"}, "is for other controls; LinuxCNC takes G64 P in the program");
  }
  if (request.dialect != Dialect::linuxcnc) {
    DialectSettings settings = dialect_settings(request, described, setup);
    for (std::size_t i = 0; i < settings.rotary_start.size(); ++i) {
      const Axis axis = kAllAxes[kLinearJoints + i];
      if (walk.has(axis) && walk.is_known(axis)) {
        settings.rotary_start[i] = walk.out()[index_of(axis)];
      }
    }
    return std::make_unique<DialectWriter>(walk, summary, settings, request.program_file);
  }
  return std::make_unique<LinuxCncWriter>(walk, summary, decimals_for(request.tolerance));
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
      : described(read_machine_description(request.machine_file, request.changes)),
        layout(described.machine.chain.layout),
        models(request.error_file.empty() ? described.errors
                                          : read_error_file(request.error_file, layout)),
        correction(described.machine.chain, model_of(models, request, model), request.axes),
        known(read_work_knowledge(request, described.machine)),
        options(walk_options(request, described.machine, known.setup)) {
    const NcSettings& nc = described.machine.nc;
    known.depends_on_place = depends_on_place(correction, nc.lower, nc.upper);
    if (request.start.empty()) return;
    const AxisValues start = axis_values("--start", request.start, &layout, false);
    options.start = known.setup.start = start.words;
    options.is_start_known = start.given;
    // programs for other controls retract first
    if (options.is_for_other_control) options.is_start_known[2] = false;
  }

  MachineDescription described;
  const JointLayout& layout;
  ErrorModels models;
  std::string model;
  Correction correction;
  WorkKnowledge known;
  WalkOptions options;
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
  is_known.fill(!known.depends_on_place);
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
  limits.retract = request.retract_Z ? request.retract_Z : prepared.described.retract_Z;
  return verify_program(written, out, prepared.correction);
}

// Before the work: a slip of the unit makes blocks without end.
void refuse_too_many_blocks(const CompensateRequest& request,
                            const controllers::ProgramSetup& setup) {
  constexpr double kMostBlocks = 1e7;
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
  if (way <= kMostBlocks * request.max_block) return;
  throw InputError({"--max-block"},
                   fmt::format("{:g} um makes {:.2g} blocks of {:.4g} m of feed; must be <= {:g} "
                               "blocks: name a longer one",
                               request.max_block / um, way / request.max_block, way, kMostBlocks));
}

}  // namespace

Compensated compensate(const CompensateRequest& request) {
  Preparation prepared(request);
  const MachineSettings& machine = prepared.described.machine;
  const JointLayout& layout = prepared.layout;
  Correction& correction = prepared.correction;
  WorkKnowledge& known = prepared.known;

  refuse_too_many_blocks(request, known.setup);

  Compensated out;
  std::optional<SmoothedFeeds> smoothed;
  if (request.smoothing > 0.0) smoothed.emplace(machine, request.smoothing, request.tolerance);
  Walk walk(prepared.options, known.setup.tools, correction, out.summary,
            request.records ? &out.record : nullptr, smoothed ? &*smoothed : nullptr);
  const auto writer = writer_of(request, prepared.described, known.setup, walk, out.summary);
  controllers::Interpreter interpreter(controllers::ProgramText::of_file(request.program_file),
                                       known.setup);
  HighestZ highest;
  while (const auto block = interpreter.next_block()) {
    throw_if_interrupted();
    if (known.depends_on_place) highest.look(*block);
    refuse_unknown_system(*block, request, known);
    if (block->text.starts_with(kHeader)) {
      out.warnings.push_back({{request.program_file, block->line},
                              "this program has been corrected before; it is corrected again"});
    }
    writer->write(*block);
  }

  const auto retract = request.retract_Z ? request.retract_Z : prepared.described.retract_Z;
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
  for (std::string& clause : writer->assumptions()) {
    out.warnings.push_back({{request.program_file}, "assumes that " + clause});
    summary.assumed.push_back(std::move(clause));
  }
  for (std::string& sentence : writer->warnings()) {
    out.warnings.push_back({{request.program_file}, std::move(sentence)});
  }
  std::vector<std::string> header = {header_line(request, machine.name, prepared.model)};
  header.push_back(path_line(request, *writer));
  for (const std::string& one : unrolled(summary)) header.push_back(one);
  for (const std::string& one : summary.assumed) header.push_back("assumed: " + one);
  for (const std::string& one : writer->warnings()) header.push_back("warning: " + one);
  out.program = writer->finish(header);

  const VerificationReport verified = verify(request, prepared, out.program);

  out.report = summary.report(layout);
  out.report.push_back(verified.text());
  for (const std::string& one : unrolled(summary)) out.report.push_back(one);
  for (const std::string& one : summary.assumed) out.report.push_back("assumed: " + one);
  out.warnings.insert(out.warnings.end(), interpreter.warnings().begin(),
                      interpreter.warnings().end());
  const auto more = warnings_of(request, summary, layout);
  out.warnings.insert(out.warnings.end(), more.begin(), more.end());
  out.json = summary.json(layout);
  out.machine = machine.name;
  return out;
}

VerificationReport verify_compensated(const CompensateRequest& request,
                                      const std::string& written) {
  Preparation prepared(request);
  return verify(request, prepared, written);
}

}  // namespace servomill::sim

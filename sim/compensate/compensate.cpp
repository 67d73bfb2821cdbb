#include "sim/compensate/compensate.h"

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
#include "plant/vocabulary/units.h"
#include "sim/canon.h"
#include "sim/compensate/dialect_writer.h"
#include "sim/compensate/linuxcnc_writer.h"
#include "sim/compensate/walk.h"
#include "sim/read_errors.h"
#include "sim/read_file.h"
#include "sim/read_machine.h"
#include "sim/scenario.h"
#include "sim/sweep/design.h"

namespace servomill::sim {
namespace {

constexpr std::string_view kHeader = "(servomill compensate:";  // of corrected programs

namespace fs = std::filesystem;
using strategies::DisplacedAxes;

constexpr double kTipTold = 0.1e-6, kAxisTold = 1e-6;  // m, rad: of less nothing is said

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

// "X=10,C=90" in mm and deg; `rotation` takes R.
struct AxisValues {
  AxisWords words = AxisWords::Zero();
  std::array<bool, kAxisWords> given{};
  double rotation = 0.0;  // rad
};

AxisValues axis_values(const std::string& option, std::string_view text, const JointLayout& layout,
                       bool takes_rotation) {
  AxisValues out;
  const Place place{option + " " + std::string(text)};
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t end = std::min(text.find(',', from), text.size());
    const std::string_view item = text.substr(from, end - from);
    from = end + 1;
    const double value =
        item.size() > 2 && item[1] == '=' ? number_of(std::string(item.substr(2))) : std::nan("");
    const bool is_rotation = takes_rotation && !item.empty() && (item[0] == 'R' || item[0] == 'r');
    const auto axis = item.empty() ? std::nullopt : axis_of(item.front());
    if (!std::isfinite(value) || (!axis && !is_rotation)) {
      throw InputError(place, "must be positions in mm and deg, such as X=10,Y=-5.5");
    }
    if (is_rotation) {
      out.rotation = value * deg;
      continue;
    }
    if (!layout.joint_of(*axis)) {
      throw InputError(place, fmt::format("the machine has no axis {}", letter(*axis)));
    }
    out.words[index_of(*axis)] = value * (is_linear(*axis) ? mm : deg);
    out.given[static_cast<std::size_t>(index_of(*axis))] = true;
  }
  return out;
}

constexpr std::array<std::string_view, 9> kWorkSystems = {"G54", "G55",   "G56",   "G57",  "G58",
                                                          "G59", "G59.1", "G59.2", "G59.3"};

// What the control knows before the program, and which work systems are known.
struct Known {
  controllers::ProgramSetup setup;
  std::set<int> work_systems;  // 1 ... 9
  bool is_assumed = false;     // nothing was said of work offsets
};

Known read_known(const CompensateRequest& request, const JointLayout& layout) {
  Known known;
  known.setup = program_setup(request.inputs, request.program_file);
  if (!request.inputs.parameter_file.empty()) {
    for (int system = 1; system <= controllers::kWorkSystems; ++system) {
      known.work_systems.insert(system);
    }
  }
  for (const std::string& text : request.work_offsets) {
    const std::size_t colon = text.find(':');
    const std::string name = colon == std::string::npos ? "G54" : text.substr(0, colon);
    const auto found = std::find(kWorkSystems.begin(), kWorkSystems.end(), name);
    if (found == kWorkSystems.end()) {
      throw InputError({"--work-offset " + text},
                       fmt::format("'{}' is none of {}", name, fmt::join(kWorkSystems, ", ")));
    }
    const auto k = static_cast<std::size_t>(found - kWorkSystems.begin());
    const AxisValues values = axis_values(
        "--work-offset", std::string_view(text).substr(colon == std::string::npos ? 0 : colon + 1),
        layout, true);
    known.setup.work_offset[k] = values.words;
    known.setup.work_rotation[k] = values.rotation;
    known.work_systems.insert(static_cast<int>(k) + 1);
  }
  known.is_assumed = known.work_systems.empty();
  if (known.is_assumed) known.work_systems.insert(1);
  return known;
}

// Moves in a work system that nobody has said the place of would be corrected for another place.
void refuse_unknown_system(const controllers::ExecutedBlock& block,
                           const CompensateRequest& request, std::set<int>& known) {
  if (block.request == nullptr) return;
  const auto& words = *block.request;
  const int system = block.state->work_system;
  if (words.code(controllers::Group::g_non_modal) == 100 && words.has('P')) {  // G10 says it
    const int P = static_cast<int>(std::lround(words['P']));
    known.insert(P == 0 ? system : P);
  }
  if (known.contains(system)) return;
  const auto& chosen = words.of(controllers::Group::g_work_system);
  const auto name = kWorkSystems[static_cast<std::size_t>(system - 1)];
  throw InputError(
      {request.program_file, block.line, chosen.column},
      fmt::format("where {0} lies in the machine is not known, and with it the errors; "
                  "--work-offset {0}:X=...,Y=... or --parameter-file say it",
                  name));
}

std::string words_text(const AxisWords& words, const JointLayout& layout) {
  std::string out;
  for (const Axis axis : kAllAxes) {
    if (!layout.joint_of(axis)) continue;
    out += fmt::format("{}{}{:g}", out.empty() ? "" : " ", letter(axis),
                       words[index_of(axis)] / (is_linear(axis) ? mm : deg));
  }
  return out;
}

// Where a work system lies: what the request says, else the parameter file. m, rad
struct WorkSystemPlace {
  AxisWords offset = AxisWords::Zero();
  double rotation = 0.0;
};

WorkSystemPlace place_of(const controllers::ProgramSetup& setup, int system) {
  const auto k = static_cast<std::size_t>(system - 1);
  const auto stored = [&](int number) {
    const auto found = setup.stored.find(number);
    return found == setup.stored.end() ? 0.0 : found->second;
  };
  WorkSystemPlace place{setup.work_offset[k], setup.work_rotation[k]};
  for (const Axis axis : kAllAxes) {
    const int i = index_of(axis);
    if (place.offset[i] != 0.0) continue;
    place.offset[i] =
        stored(controllers::parameter::work_offset(system) + i) * (is_linear(axis) ? mm : deg);
  }
  if (place.rotation == 0.0) {
    place.rotation = stored(controllers::parameter::work_rotation(system)) * deg;
  }
  return place;
}

// What the result relies on.
std::vector<std::string> assumptions(const CompensateRequest& request, const Known& known,
                                     const Summary& summary, const JointLayout& layout) {
  std::vector<std::string> out;
  if (known.is_assumed) {
    out.emplace_back("G54 lies at machine zero: no --work-offset and no --parameter-file say more");
  }
  for (const int system : known.work_systems) {
    const WorkSystemPlace place = place_of(known.setup, system);
    const bool is_there = !place.offset.isZero(0.0) || place.rotation != 0.0;
    if (known.is_assumed || (!is_there && system != 1)) continue;
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
  if (summary.takes_blocks_with_slash) {
    out.emplace_back("lines with '/' are taken: what moves or changes modes lost its slash");
  }
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

std::vector<Fault> warnings_of(const CompensateRequest& request, const Known& known,
                               const Summary& summary, const JointLayout& layout) {
  std::vector<Fault> out;
  if (known.is_assumed) {
    out.push_back({{request.program_file},
                   "nothing says where G54 lies, and errors depend on it: taken at machine zero; "
                   "--work-offset or --parameter-file say it"});
  }
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
  if (summary.left.tip > kTipTold) {
    left.push_back(fmt::format("{:.2f} um of the tip", summary.left.tip / um));
  }
  if (summary.left.axis > kAxisTold) {
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
  options.fit.allow_arcs = request.dialect == Dialect::linuxcnc;
  options.splits_rapids = request.splits_rapids;
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

std::unique_ptr<ProgramWriter> writer_of(const CompensateRequest& request, Walk& walk,
                                         Summary& summary) {
  if (request.dialect != Dialect::linuxcnc) {
    return std::make_unique<DialectWriter>(walk, summary, request.dialect, request.program_file);
  }
  return std::make_unique<LinuxCncWriter>(walk, summary, decimals_for(request.tolerance));
}

}  // namespace

Compensated compensate(const CompensateRequest& request) {
  const MachineDescription described =
      read_machine_description(request.machine_file, request.changes);
  const MachineSettings& machine = described.machine;
  ErrorModels models = described.errors;
  const JointLayout& layout = machine.chain.layout;
  if (!request.error_file.empty()) models = read_error_file(request.error_file, layout);
  std::string model;
  Correction correction(machine.chain, model_of(models, request, model), request.axes);
  Known known = read_known(request, layout);
  WalkOptions options = walk_options(request, machine, known.setup);
  if (!request.start.empty()) {
    const AxisValues start = axis_values("--start", request.start, layout, false);
    options.start = known.setup.start = start.words;
    options.is_start_known = start.given;
  }

  Compensated out;
  Walk walk(options, known.setup.tools, correction, out.summary,
            request.records ? &out.record : nullptr);
  const auto writer = writer_of(request, walk, out.summary);
  controllers::Interpreter interpreter(controllers::ProgramText::of_file(request.program_file),
                                       known.setup);
  while (const auto block = interpreter.next_block()) {
    refuse_unknown_system(*block, request, known.work_systems);
    if (block->text.starts_with(kHeader)) {
      out.warnings.push_back({{request.program_file, block->line},
                              "this program has been corrected before; it is corrected again"});
    }
    writer->write(*block);
  }

  Summary& summary = out.summary;
  summary.assumed = assumptions(request, known, summary, layout);
  std::vector<std::string> header = {header_line(request, machine.name, model)};
  header.push_back(fmt::format("path within {:g} um of the corrected one", request.tolerance / um));
  for (const std::string& one : unrolled(summary)) header.push_back(one);
  for (const std::string& one : summary.assumed) header.push_back("assumed: " + one);
  out.program = writer->finish(header);

  out.report = summary.report(layout);
  for (const std::string& one : unrolled(summary)) out.report.push_back(one);
  for (const std::string& one : summary.assumed) out.report.push_back("assumed: " + one);
  out.warnings.insert(out.warnings.end(), interpreter.warnings().begin(),
                      interpreter.warnings().end());
  const auto more = warnings_of(request, known, summary, layout);
  out.warnings.insert(out.warnings.end(), more.begin(), more.end());
  out.json = summary.json(layout);
  out.machine = machine.name;
  return out;
}

}  // namespace servomill::sim

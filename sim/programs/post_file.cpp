#include "sim/programs/post_file.h"
#include "plant/vocabulary/progress.h"
#include "sim/config/option_value.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "controllers/gcode/printer.h"
#include "plant/vocabulary/units.h"
#include "sim/input/machine_description.h"
#include "sim/model/machine.h"
#include "sim/programs/compensate/work_knowledge.h"
#include "sim/programs/verify_post.h"
#include "sim/system/read_file.h"

namespace servomill::sim::programs {
namespace {

namespace fs = std::filesystem;

std::string names_of(const JointLayout& layout) {
  std::string out;
  for (const auto& axis : layout.axis) {
    if (axis) out += letter(*axis);
  }
  return out;
}

// "A=10,C=90"
Joints joints_of(const std::string& text, const JointLayout& layout) {
  AxisWords words = AxisWords::Zero();
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = std::min(text.find(',', from), text.size());
    const std::string word = text.substr(from, end - from);
    from = end + 1;
    const auto axis = word.empty() ? std::nullopt : axis_of(word.front());
    if (!axis || word.size() < 3 || word[1] != '=') {
      throw InputError({"--start " + text},
                       "must be positions, such as A=10,C=90 (in mm and deg) or \"C=90 deg\"");
    }
    const config::ScaledText value = config::scale_option(
        std::string_view(word).substr(2), is_linear(*axis) ? config::kLength : config::kAngle,
        is_linear(*axis) ? "mm" : "deg");
    if (!value.complaint.empty()) {
      throw InputError({"--start " + text}, fmt::format("{}: {}", word, value.complaint));
    }
    if (!layout.joint_of(*axis)) {
      throw InputError({"--start " + text}, fmt::format("the machine has no axis {}; it has {}",
                                                        letter(*axis), names_of(layout)));
    }
    words[index_of(*axis)] = value.si;
  }
  return layout.joints(words);
}

std::set<int> tools_loaded(const controllers::ClData& data, int without) {
  std::set<int> tools;
  for (const auto& record : data.records) {
    if (record.kind == MoveKind::tool) tools.insert(record.number);
  }
  if (without > 0 && data.first_without_tool() != nullptr) tools.insert(without);
  return tools;
}

std::string no_length_of(int tool) {
  return fmt::format(
      "the length of tool {} is unknown; add --tool-length \"110 mm\" or --tools TABLE (0 is "
      "allowed)",
      tool);
}

void take_tools(const PostRequest& request, const controllers::ClData& data,
                controllers::PostOptions& options) {
  if (!request.tool_table.empty()) {
    options.tools = controllers::ToolTable::parse(
        system::read_file(request.tool_table, {}, "tool table"), request.tool_table);
  } else if (request.tool_length) {
    if (options.tool == 0 && !request.has_no_tool) options.tool = 1;
    for (const int number : tools_loaded(data, options.tool)) {
      controllers::ToolEntry tool;
      tool.number = number;
      tool.offset[index_of(Axis::Z)] = *request.tool_length;
      options.tools.add(tool);
    }
  }
  for (const std::string& text : request.tool_lengths) add_tool_length(text, options.tools);
}

bool has_length(const PostRequest& request, int tool) {
  const std::string begin = fmt::format("{}=", tool);
  return request.tool_length || !request.tool_table.empty() ||
         std::any_of(request.tool_lengths.begin(), request.tool_lengths.end(),
                     [&](const std::string& text) { return text.starts_with(begin); });
}

// 0 may be given as length, but is not assumed: under G49 and H0 the spindle nose would go where
// the tip belongs, and they cancel the length that an operator has set.
void refuse_unknown_tools(const PostRequest& request, const controllers::ClData& data) {
  const int wanted = request.options.tool;
  if (const controllers::ClRecord* first = data.first_without_tool()) {
    const bool loads_later =
        std::any_of(data.records.begin(), data.records.end(),
                    [](const controllers::ClRecord& r) { return r.kind == MoveKind::tool; });
    const bool is_known =
        wanted > 0 || (request.tool_length && (request.has_no_tool || !loads_later));
    if (!is_known) {
      throw InputError(
          {request.cl_file, first->line, 0},
          "no tool is loaded before this location; add LOADTL/N before it or --tool N, and "
          "--tool-length or --tools (an empty spindle: --tool 0 --tool-length 0)");
    }
    if (request.has_no_tool && *request.tool_length > 0.0) {
      throw InputError({"--tool 0"},
                       "an empty spindle has no tool length; use --tool N, or --tool-length 0");
    }
    if (!has_length(request, wanted)) {
      throw InputError({request.cl_file, first->line, 0}, no_length_of(wanted));
    }
  }
  for (const controllers::ClRecord& record : data.records) {
    if (record.kind != MoveKind::tool || has_length(request, record.number)) continue;
    throw InputError({request.cl_file, record.line, 0}, no_length_of(record.number));
  }
}

// With rotary axes the positions depend on the place of the part: 0 may be given,
// but is not assumed. Under tip control X and Y are approached without it, where the table turns.
void refuse_unknown_place(const PostRequest& request, const plant::MachineChain& chain) {
  if (request.work_offset) return;
  const bool is_tip = request.options.mode == controllers::PostMode::tip;
  if (is_tip && request.options.approach == controllers::Approach::direct) return;
  const bool turns =
      std::any_of(chain.axes.begin(), chain.axes.end(), [is_tip](const plant::ChainAxis& a) {
        return !is_linear(a.axis) && (!is_tip || a.side == plant::Side::workpiece);
      });
  if (!turns) return;
  throw InputError(
      {request.cl_file},
      fmt::format("the work offset is unknown, and the rotary axes of this machine rotate about "
                  "fixed points; add --work-offset X,Y,Z (0,0,0 is allowed){}",
                  is_tip ? " or --approach direct" : ""));
}

// Z of the machine from which every way down is free.
double retract_height(const PostRequest& request, const input::MachineDescription& machine) {
  const JointLayout& layout = machine.machine->chain.layout;
  constexpr int kZ = 2;
  if (!layout.has(kZ)) {
    throw InputError({request.machine_file}, "the machine has no axis Z; use --approach direct");
  }
  const double lower = machine.machine->nc.lower[kZ], upper = machine.machine->nc.upper[kZ];
  const double Z = request.retract_Z.value_or(machine.retract_Z.value_or(upper));
  if (!std::isfinite(Z)) {
    throw InputError({request.machine_file},
                     "Z has no travel, so the retract height is unknown; add axis.Z.retract_mm or "
                     "--retract Z=...");
  }
  if (Z >= lower && Z <= upper) return Z;
  throw InputError({request.retract_Z ? std::string("--retract") : request.machine_file},
                   fmt::format("Z = {:g} mm; outside the travel of {:g} to {:g} mm", Z / mm,
                               lower / mm, upper / mm));
}

std::string header(const PostRequest& request, const controllers::PostOptions& options,
                   const controllers::ClData& data, const std::string& machine) {
  std::string text = fmt::format("servomill post: {} for {}",
                                 fs::path(request.cl_file).filename().string(), machine);
  if (!data.part.empty()) text += fmt::format("\npart: {}", data.part);
  const double tip = options.tolerance.tip / um, axis = options.tolerance.axis / urad;
  switch (options.mode) {
    case controllers::PostMode::joints:
      text += fmt::format("\nTCP within {:g} um, tool axis within {:g} urad of the straight path",
                          tip, axis);
      break;
    case controllers::PostMode::locations:
      text +=
          "\none block per location: between them TCP and tool axis follow from the axis "
          "motion";
      break;
    case controllers::PostMode::tip:
      text += fmt::format("\nG43.4: X Y Z are the TCP; tool axis within {:g} urad", axis);
      break;
  }
  const Eigen::Vector3d& zero = options.work_offset;
  text += fmt::format("\nwork offset (G{}): X{:g} Y{:g} Z{:g} in the machine, rotary axes at zero",
                      53 + options.work_system, zero[0] / mm, zero[1] / mm, zero[2] / mm);
  if (options.approach == controllers::Approach::safe) {
    text +=
        fmt::format("\nretracts to machine Z{:g}; {:g} mm along the tool axis to and from the part",
                    options.safe.retract_Z / mm, options.safe.clearance / mm);
  }
  for (const int number : tools_loaded(data, options.tool)) {
    const auto* tool = options.tools.find(number);
    text += fmt::format("\ntool {}: length {:g} mm", number,
                        tool != nullptr ? tool->offset[index_of(Axis::Z)] / mm : 0.0);
  }
  return text;
}

}  // namespace

PostProcessedFile post_file(PostRequest request, std::vector<controllers::Warning>* of_refused) {
  const input::MachineDescription described =
      input::read_machine_description(request.machine_file, request.changes);
  const model::MachineSettings& machine = *described.machine;
  std::vector<controllers::Warning> ignored;
  std::vector<controllers::Warning>& warnings = of_refused != nullptr ? *of_refused : ignored;
  const controllers::ClData data = controllers::read_cl_data(
      system::read_file(request.cl_file, {}, "cutter location file"), request.cl_file, &warnings);
  warnings = data.warnings;
  refuse_unknown_place(request, machine.chain);
  controllers::PostOptions& options = request.options;
  options.start = joints_of(request.start, machine.chain.layout);
  for (int j = 0; j < kJoints; ++j) {
    if (machine.nc.v_max[j] > 0.0) options.v_max[j] = machine.nc.v_max[j];
  }
  options.work_offset = request.work_offset.value_or(Eigen::Vector3d::Zero());
  if (options.approach == controllers::Approach::safe) {
    options.safe.retract_Z = retract_height(request, described);
  }
  refuse_unknown_tools(request, data);
  take_tools(request, data, options);

  plant::InverseSettings settings;
  settings.lower = machine.nc.lower;
  settings.upper = machine.nc.upper;
  const plant::InverseKinematics inverse(machine.chain, settings);
  Stage parts("parts", 2.0, Steps::unlike);  // post-processing, verification
  controllers::PostProcessed post_processed =
      controllers::post(data, request.cl_file, inverse, options, &warnings);
  warnings.clear();
  parts.advance();

  controllers::PrintOptions print;
  print.axes = names_of(machine.chain.layout);
  print.tcp_control = options.mode == controllers::PostMode::tip;
  PostProcessedFile out;
  out.program = controllers::print_program(post_processed.moves, print,
                                           header(request, options, data, machine.name))
                    .text;
  out.verified = to_string(verify_post(out.program, data, machine, options, request.cl_file));
  out.warnings = data.warnings;
  out.warnings.insert(out.warnings.end(), post_processed.warnings.begin(),
                      post_processed.warnings.end());
  out.locations = data.locations();
  out.inserted = post_processed.inserted;
  return out;
}

}  // namespace servomill::sim::programs

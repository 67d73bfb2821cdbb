#include "sim/post_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <set>

#include "controllers/gcode/printer.h"
#include "plant/vocabulary/units.h"
#include "sim/config/document.h"
#include "sim/read_file.h"
#include "sim/read_machine.h"
#include "sim/sweep/design.h"

namespace servomill::sim {
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
    const double value =
        axis && word.substr(1, 1) == "=" ? number_of(word.substr(2)) : std::nan("");
    if (!std::isfinite(value)) {
      throw InputError({"--start " + text}, "must be positions such as A=10,C=90");
    }
    if (!layout.joint_of(*axis)) {
      throw InputError({"--start " + text}, fmt::format("the machine has no axis {}; it has {}",
                                                        letter(*axis), names_of(layout)));
    }
    words[index_of(*axis)] = value * (is_linear(*axis) ? mm : deg);
  }
  return layout.joints(words);
}

MachineSettings read_changed_machine(const std::string& path,
                                     const std::vector<std::string>& changes) {
  Document document = Document::from_file(path);
  for (const std::string& change : changes) document.set(change);
  Reader root(document);
  MachineSettings machine = read_machine(root);
  root.finish();
  return machine;
}

std::set<int> tools_loaded(const controllers::ClData& data, int without) {
  std::set<int> tools;
  for (const auto& record : data.records) {
    if (record.kind == MoveKind::tool) tools.insert(record.number);
  }
  if (tools.empty() && without > 0) tools.insert(without);
  return tools;
}

void take_tools(const PostRequest& request, const controllers::ClData& data,
                controllers::PostOptions& options) {
  if (!request.tool_table.empty()) {
    options.tools = controllers::ToolTable::parse(read_file(request.tool_table, {}, "tool table"),
                                                  request.tool_table);
  } else if (request.tool_length) {
    if (options.tool == 0) options.tool = 1;
    for (const int number : tools_loaded(data, options.tool)) {
      controllers::ToolEntry tool;
      tool.number = number;
      tool.offset[index_of(Axis::Z)] = *request.tool_length;
      options.tools.add(tool);
    }
  }
}

// Where the head turns, the axes go with the length of the tool; elsewhere G43 takes it into
// account.
void refuse_unknown_length(const PostRequest& request, const plant::MachineChain& chain) {
  const bool head_turns =
      std::any_of(chain.axes.begin(), chain.axes.end(), [](const plant::ChainAxis& axis) {
        return axis.side == plant::Side::tool && !is_linear(axis.axis);
      });
  const bool is_known = request.tool_length || !request.tool_table.empty();
  if (!head_turns || is_known || request.options.mode == controllers::PostMode::tip) return;
  throw InputError(
      {request.cl_file},
      "the length of the tool is not given, and the head of this machine turns it; add "
      "--tool-length or --tools");
}

std::string header(const PostRequest& request, const controllers::PostOptions& options,
                   const controllers::ClData& data, const std::string& machine) {
  std::string text = fmt::format("servomill post: {} for {}",
                                 fs::path(request.cl_file).filename().string(), machine);
  if (!data.part.empty()) text += fmt::format("\npart: {}", data.part);
  const double tip = options.tolerance.tip / um, axis = options.tolerance.axis / urad;
  switch (options.mode) {
    case controllers::PostMode::joints:
      text += fmt::format("\ntip within {:g} um, tool axis within {:g} urad of the straight way",
                          tip, axis);
      break;
    case controllers::PostMode::locations:
      text += "\none block a location: between them tip and tool axis go where the axes take them";
      break;
    case controllers::PostMode::tip:
      text += fmt::format("\nG43.4: X Y Z are the tip; tool axis within {:g} urad", axis);
      break;
  }
  const Eigen::Vector3d& zero = options.part_zero;
  text += fmt::format("\npart zero (G{}): X{:g} Y{:g} Z{:g} in the machine, rotary axes at zero",
                      53 + options.work_system, zero[0] / mm, zero[1] / mm, zero[2] / mm);
  for (const int number : tools_loaded(data, options.tool)) {
    const auto* tool = options.tools.find(number);
    text += fmt::format("\ntool {}: length {:g} mm", number,
                        tool != nullptr ? tool->offset[index_of(Axis::Z)] / mm : 0.0);
  }
  return text;
}

}  // namespace

PostedFile post_file(PostRequest request, std::vector<controllers::Warning>* of_refused) {
  const MachineSettings machine = read_changed_machine(request.machine_file, request.changes);
  std::vector<controllers::Warning> ignored;
  std::vector<controllers::Warning>& told = of_refused != nullptr ? *of_refused : ignored;
  const controllers::ClData data = controllers::read_cl_data(
      read_file(request.cl_file, {}, "cutter location file"), request.cl_file, &told);
  told = data.warnings;
  refuse_unknown_length(request, machine.chain);
  controllers::PostOptions& options = request.options;
  options.start = joints_of(request.start, machine.chain.layout);
  options.v_max = machine.nc.v_max;
  take_tools(request, data, options);

  plant::InverseSettings settings;
  settings.lower = machine.nc.lower;
  settings.upper = machine.nc.upper;
  const plant::InverseKinematics inverse(machine.chain, settings);
  controllers::Posted posted = controllers::post(data, request.cl_file, inverse, options, &told);
  told.clear();

  controllers::PrintOptions print;
  print.axes = names_of(machine.chain.layout);
  print.tip_control = options.mode == controllers::PostMode::tip;
  PostedFile out;
  out.program =
      controllers::print_program(posted.moves, print, header(request, options, data, machine.name))
          .text;
  out.warnings = data.warnings;
  out.warnings.insert(out.warnings.end(), posted.warnings.begin(), posted.warnings.end());
  out.locations = data.locations();
  out.inserted = posted.inserted;
  return out;
}

}  // namespace servomill::sim

#include "tools/servomill/fmu_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/fmu/axis_variables.h"
#include "sim/fmu/exported_axis.h"
#include "sim/fmu/machine_constants.h"
#include "sim/fmu/tool.h"
#include "sim/model/run_settings.h"
#include "sim/model/scenario.h"
#include "sim/run/build_identity.h"
#include "tools/servomill/axis_options.h"

namespace servomill::tools {
namespace {

// Delay of the reading, which the cases must agree on. @throws InputError
Tick reading_delay(const sim::model::Scenario& scenario) {
  std::optional<Tick> delay;
  for (const sim::model::CaseSpec& one : scenario.cases) {
    if (one.servo == sim::model::ServoModel::ideal) continue;
    const Tick its = scenario.reading_delay_of(one);
    if (delay && *delay != its) {
      throw InputError({"--case"},
                       "is needed: the delay of the readings is not the same in all cases");
    }
    delay = its;
  }
  if (delay) return *delay;
  throw InputError({scenario.cases.size() == 1 ? "--case" : "servomill fmu"},
                   "axes of an ideal servo have no loops: there is nothing to export");
}

void refuse_if(const std::string& why, const Options& options, const std::string& what) {
  if (!why.empty()) throw InputError({options.word()}, fmt::format("{}: {}", what, why));
}

std::vector<sim::fmu::AxisConstants> axes_of(const Options& options,
                                             const sim::model::Scenario& scenario,
                                             const std::vector<int>& joints) {
  const Tick delay = reading_delay(scenario);
  std::vector<sim::fmu::AxisConstants> axes;
  for (const int joint : joints) {
    sim::fmu::AxisConstants& axis =
        axes.emplace_back(sim::fmu::exported_axis(scenario, joint, delay));
    axis.program = sim::run::build_identity();
    if (options.has("case")) axis.case_name = options.get<std::string>("case");
    refuse_if(sim::fmu::why_not_exported(axis), options, "axis " + axis.axis);
  }
  return axes;
}

// Tip of a tool of the scenario; without --tool the spindle nose.
Eigen::Vector3d chosen_tip(const Options& options, const sim::model::Scenario& scenario) {
  if (!options.has("tool")) return Eigen::Vector3d::Zero();
  const int number = options.get<int>("tool");
  const controllers::ToolEntry* tool = scenario.program.tools.find(number);
  if (tool != nullptr) return -tool->offset.head<3>();
  std::vector<int> numbers;
  for (const auto& [its, entry] : scenario.program.tools.entries()) numbers.push_back(its);
  throw InputError(
      {"--tool"},
      fmt::format("the scenario has no tool {}; {}", number,
                  numbers.empty() ? std::string("it has none")
                                  : fmt::format("it has {}", fmt::join(numbers, ", "))));
}

sim::fmu::MachineConstants chosen_parts(const Options& options) {
  const auto read = scenario_for_axes(options);
  const sim::model::Scenario& scenario = *read;
  const bool whole = options.has("machine");
  if (whole && options.has("axis")) {
    throw InputError({"--axis"}, "cannot be given with --machine, which exports all axes");
  }
  if (!whole && options.has("tool")) throw InputError({"--tool"}, "needs --machine");
  sim::fmu::MachineConstants out;
  if (whole) {
    out.kinematics = sim::fmu::exported_kinematics(scenario);
    out.kinematics->p_ST = chosen_tip(options, scenario);
    refuse_if(sim::fmu::why_not_exported(*out.kinematics, scenario.machine), options, "--machine");
  }
  out.axes = axes_of(options, scenario,
                     whole ? scenario.machine.joints() : chosen_joints(options, scenario.machine));
  return out;
}

std::string lines_of(std::span<const sim::fmu::Variable> variables) {
  std::string out;
  for (const sim::fmu::Variable& one : variables) {
    constexpr std::string_view kNames[] = {"", "parameter", "input", "output", "constant"};
    const std::string_view role = kNames[static_cast<std::size_t>(one.causality)];
    if (!role.empty()) {
      out += fmt::format("  {:<10} {:<26} {}\n", role, one.name, one.description);
    }
  }
  return out;
}

// Lines on what an FMU contains.
std::vector<std::string> report_of(const sim::fmu::MachineConstants& machine) {
  std::vector<std::string> lines;
  for (const sim::fmu::AxisConstants& axis : machine.axes) {
    lines.push_back(axis_headline(axis.machine, axis.joint, axis.reading_delay));
  }
  if (machine.kinematics) {
    const Eigen::Vector3d tip = machine.kinematics->p_ST / mm;
    lines.push_back(fmt::format("tool centre point at X{:g} Y{:g} Z{:g} mm in the spindle nose",
                                tip.x(), tip.y(), tip.z()));
  }
  return lines;
}

}  // namespace

FmuContents fmu_contents(const Options& options) {
  const auto machine = std::make_shared<const sim::fmu::MachineConstants>(chosen_parts(options));
  FmuContents out{machine, {}, report_of(*machine)};
  for (const sim::fmu::AxisConstants& one : machine->axes) out.axes.push_back(one.axis);
  return out;
}

std::string fmu_variables() {
  return "\nVariables (m or rad, N or N m, s, A); of several axes Y.position, ...:\n" +
         lines_of(sim::fmu::variables()) + "of --machine besides:\n" +
         lines_of(sim::fmu::tool_variables());
}

}  // namespace servomill::tools

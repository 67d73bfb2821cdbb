#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <span>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/fmu/axis_variables.h"
#include "sim/fmu/exported_axis.h"
#include "sim/fmu/fmu_package.h"
#include "sim/fmu/tool.h"
#include "sim/run/build_identity.h"
#include "sim/system/json.h"
#include "sim/system/program_folder.h"
#include "sim/system/read_file.h"
#include "sim/system/write_file.h"
#include "tools/servomill/axis_options.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

constexpr std::array<std::string_view, 2> kVersions = {"2", "3"};

// The library is in the folder of the program, or, of an installed one, in that of libraries.
std::string library_file() {
  const std::string name = std::string(sim::fmu::kModelIdentifier) + ".so";
  const std::filesystem::path program = sim::system::program_folder();
  const std::filesystem::path installed = program / SERVOMILL_LIBRARIES / name;
  if (std::filesystem::exists(installed)) return installed.lexically_normal().string();
  return (program / name).string();
}

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
  const sim::model::Scenario scenario = scenario_for_axes(options);
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

std::string list_of_variables() {
  return "\nVariables (m or rad, N or N m, s, A); of several axes Y.position, ...:\n" +
         lines_of(sim::fmu::variables()) + "of --machine besides:\n" +
         lines_of(sim::fmu::tool_variables());
}

std::string fmu_json(const std::vector<sim::fmu::AxisConstants>& axes, const std::string& file,
                     std::string_view version) {
  std::vector<std::string> letters;
  for (const sim::fmu::AxisConstants& one : axes) letters.push_back(one.axis);
  return sim::system::JsonObject()
      .text("file", file)
      .text("fmi", fmt::format("{}.0", version))
      .raw("axes", sim::system::json_texts(letters))
      .line();
}

void add_fmu_options(Options& options) {
  add_axis_options(options);
  options.add()("machine", "all axes, and the tool position from kinematics and geometric errors");
  options.add()("tool", po::value<int>()->value_name("T"),
                "with --machine: tool of the scenario whose tip is the measured point (default: "
                "the spindle nose; FMU parameters tool.tip_x, _y, _z)");
  options.add()("fmi", po::value<std::string>()->default_value("2")->value_name("2|3"),
                "version of the Functional Mock-up Interface");
  options.add()("output,o", po::value<std::string>()->value_name("DRIVE.fmu"), "the FMU");
  options.add()("force,f", "replaces the FMU if it exists");
  options.add()("json", "prints the report as one JSON object");
  options.add()("quiet,q", "prints only faults");
}

}  // namespace

int fmu_command(const Arguments& arguments) {
  Options options(
      "fmu", "SCENARIO.toml --axis Y|X,Y|all or --machine [--case NAME] [--fmi 2|3] -o DRIVE.fmu",
      "Exports one axis (drive and NC loops), several axes, or the whole machine as a\n"
      "co-simulation unit (FMU) for other simulators. For the same setpoints its results equal\n"
      "those of servomill run bit for bit. Strategies are not included: their corrections enter\n"
      "at the inputs.\n" +
          list_of_variables(),
      "SCENARIO.toml");
  add_fmu_options(options);
  if (!options.parse(arguments)) return kDone;
  const std::size_t version = choice_option(options, "fmi", kVersions);
  const std::string out = output_of(options, "output", ".fmu");
  if (out.empty()) throw InputError({"--output"}, "is missing");
  const sim::fmu::MachineConstants machine = chosen_parts(options);
  const std::string library =
      sim::system::read_file(library_file(), {}, "library of exported axes");
  sim::system::write_text_file(
      out, sim::fmu::fmu_bytes(static_cast<sim::fmu::FmiVersion>(version), machine, library),
      options.has("force"));
  if (options.has("json")) {
    fmt::print("{}\n", fmu_json(machine.axes, out, kVersions[version]));
    return kDone;
  }
  if (options.has("quiet")) return kDone;
  for (const sim::fmu::AxisConstants& axis : machine.axes) {
    fmt::print("{}\n", axis_headline(axis.machine, axis.joint, axis.reading_delay));
  }
  if (machine.kinematics) {
    const Eigen::Vector3d tip = machine.kinematics->p_ST / mm;
    fmt::print("tool centre point at X{:g} Y{:g} Z{:g} mm in the spindle nose\n", tip.x(), tip.y(),
               tip.z());
  }
  fmt::print("written to {} (FMI {}.0, co-simulation)\n", out, kVersions[version]);
  return kDone;
}

}  // namespace servomill::tools

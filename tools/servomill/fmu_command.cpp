#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/fmu/axis_variables.h"
#include "sim/fmu/exported_axis.h"
#include "sim/fmu/fmu_package.h"
#include "sim/run/build_identity.h"
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

std::vector<sim::fmu::AxisConstants> chosen_axes(const Options& options) {
  const sim::model::Scenario scenario = scenario_for_axes(options);
  const Tick delay = reading_delay(scenario);
  std::vector<sim::fmu::AxisConstants> axes;
  for (const int joint : chosen_joints(options, scenario.machine)) {
    sim::fmu::AxisConstants& axis =
        axes.emplace_back(sim::fmu::exported_axis(scenario, joint, delay));
    axis.program = sim::run::build_identity();
    if (options.has("case")) axis.case_name = options.get<std::string>("case");
    const std::string why = sim::fmu::why_not_exported(axis);
    if (!why.empty()) {
      throw InputError({options.word()}, fmt::format("axis {}: {}", axis.axis, why));
    }
  }
  return axes;
}

std::string list_of_variables() {
  std::string out = "\nVariables (m or rad, N or N m, s, A); of several axes Y.position, ...:\n";
  for (const sim::fmu::Variable& one : sim::fmu::variables()) {
    constexpr std::string_view kNames[] = {"", "parameter", "input", "output", "constant"};
    const std::string_view role = kNames[static_cast<std::size_t>(one.causality)];
    if (!role.empty()) {
      out += fmt::format("  {:<10} {:<26} {}\n", role, one.name, one.description);
    }
  }
  return out;
}

void add_fmu_options(Options& options) {
  add_axis_options(options);
  options.add()("fmi", po::value<std::string>()->default_value("2")->value_name("2|3"),
                "version of the Functional Mock-up Interface");
  options.add()("output,o", po::value<std::string>()->value_name("DRIVE.fmu"), "the FMU");
  options.add()("force,f", "replaces the FMU if it exists");
  options.add()("quiet,q", "prints only faults");
}

}  // namespace

int fmu_command(const Arguments& arguments) {
  Options options(
      "fmu", "SCENARIO.toml --axis Y|X,Y|all [--case NAME] [--fmi 2|3] -o DRIVE.fmu",
      "Exports an axis, drive and NC loops, or several, as a co-simulation unit (FMU) for other "
      "simulators.\nIt gives the bits of servomill run for the same setpoints; "
      "strategies stay outside: their\ncorrections enter at the inputs.\n" +
          list_of_variables(),
      "SCENARIO.toml");
  add_fmu_options(options);
  if (!options.parse(arguments)) return kDone;
  const std::size_t version = choice_option(options, "fmi", kVersions);
  const std::string out = output_of(options, "output", ".fmu");
  if (out.empty()) throw InputError({"--output"}, "is missing");
  const std::vector<sim::fmu::AxisConstants> axes = chosen_axes(options);
  const std::string library =
      sim::system::read_file(library_file(), {}, "library of exported axes");
  sim::system::write_text_file(
      out, sim::fmu::fmu_bytes(static_cast<sim::fmu::FmiVersion>(version), axes, library),
      options.has("force"));
  if (options.has("quiet")) return kDone;
  for (const sim::fmu::AxisConstants& axis : axes) {
    fmt::print("{}\n", axis_headline(axis.machine, axis.joint, axis.reading_delay));
  }
  fmt::print("written to {} (FMI {}.0, co-simulation)\n", out, kVersions[version]);
  return kDone;
}

}  // namespace servomill::tools

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/fmu/fmu_package.h"
#include "sim/fmu/model_description.h"
#include "sim/system/json.h"
#include "sim/system/program_folder.h"
#include "sim/system/read_file.h"
#include "sim/system/write_file.h"
#include "tools/servomill/axis_options.h"
#include "tools/servomill/fmu_options.h"

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

std::string fmu_json(const std::vector<std::string>& axes, const std::string& file,
                     std::string_view version) {
  return sim::system::JsonObject()
      .text("file", file)
      .text("fmi", fmt::format("{}.0", version))
      .raw("axes", sim::system::json_texts(axes))
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
          fmu_variables(),
      "SCENARIO.toml");
  add_fmu_options(options);
  if (!options.parse(arguments)) return kDone;
  const std::size_t version = choice_option(options, "fmi", kVersions);
  const std::string out = output_of(options, "output", ".fmu");
  if (out.empty()) throw InputError({"--output"}, "is missing");
  const FmuContents contents = fmu_contents(options);
  const std::string library =
      sim::system::read_file(library_file(), {}, "library of exported axes");
  sim::system::write_text_file(
      out,
      sim::fmu::fmu_bytes(static_cast<sim::fmu::FmiVersion>(version), *contents.machine, library),
      options.has("force"));
  if (options.has("json")) {
    fmt::print("{}\n", fmu_json(contents.axes, out, kVersions[version]));
    return kDone;
  }
  if (options.has("quiet")) return kDone;
  for (const std::string& line : contents.report) fmt::print("{}\n", line);
  fmt::print("written to {} (FMI {}.0, co-simulation)\n", out, kVersions[version]);
  return kDone;
}

}  // namespace servomill::tools

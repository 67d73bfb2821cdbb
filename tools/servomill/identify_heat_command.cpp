#include <fmt/format.h>

#include <algorithm>

#include "plant/vocabulary/input_error.h"
#include "sim/calibration/heat_readings.h"
#include "sim/calibration/heat_regression.h"
#include "sim/input/machine_description.h"
#include "sim/model/machine_parts.h"
#include "tools/servomill/command.h"
#include "tools/servomill/day_readings.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {

namespace {

namespace po = boost::program_options;
using sim::calibration::HeatReadings;

void add_heat_options(Options& options) {
  const auto text = [](const char* name) { return po::value<std::string>()->value_name(name); };
  options.add()("machine", text("MACHINE.toml"), "machine that was measured, with [heat.sensor]");
  options.add()("case", text("NAME"), "DAY.h5: case whose day is read (default: the only one)");
  options.add()("errors", text("LIST"),
                "errors to be identified, separated by commas (default: EXX,EYY,EZZ)");
  options.add()("output,o", text("OUT.toml"),
                "writes the machine with errors_per_K of its sensors, and their covariance");
  options.add()("json", "prints one JSON object, numbers in um and urad per kelvin");
  options.add()("force,f", "replaces OUT.toml if it exists");
}

std::vector<plant::ErrorName> errors_of(const Options& options, const JointLayout& layout) {
  const Place place{"--errors"};
  const std::string list = options.has("errors") ? options.get<std::string>("errors") : "";
  std::vector<plant::ErrorName> out;
  for (std::size_t begin = 0; begin < list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    out.push_back(plant::parse_error_name(list.substr(begin, end - begin), layout, place));
    if (std::count(out.begin(), out.end(), out.back()) > 1) {
      throw InputError(place, fmt::format("names {} twice", to_string(out.back())));
    }
    begin = end + 1;
  }
  if (!out.empty()) return out;
  if (options.has("errors")) throw InputError(place, "names no error");
  for (const Axis axis : {Axis::X, Axis::Y, Axis::Z}) {
    if (layout.joint_of(axis)) out.push_back({axis, axis, false});
  }
  return out;
}

}  // namespace

int identify_heat_command(const Arguments& arguments) {
  Options options(
      "identify-heat", "READINGS.csv|DAY.h5 --machine MACHINE.toml [-o OUT.toml]",
      "Finds errors per kelvin for the temperature sensors of a machine, by linear regression of "
      "the drift of its tip. The drift is that of a day in a result file, or of a table with the "
      "columns X_mm, ..., C_deg, tool_mm, NAME_degC for each sensor and drift_X_um, drift_Y_um, "
      "drift_Z_um. The strategy thermal compensates these errors (machine = \"OUT.toml\").",
      "READINGS.csv|DAY.h5");
  add_heat_options(options);
  if (!options.parse(arguments)) return kDone;
  const std::string path = options.word();
  const std::string output = output_of(options, "output", ".toml");
  if (!options.has("machine")) throw InputError({"--machine"}, "is missing");
  const auto& machine_path = options.get<std::string>("machine");
  const auto machine = sim::input::read_machine_description(machine_path).machine;
  if (!sim::model::has_heat(*machine)) throw InputError({machine_path}, "has no [heat]");
  if (!path.ends_with(".h5") && options.has("case")) {
    throw InputError({"--case"}, "is of result files (DAY.h5) only");
  }
  ProgressLine line(options);
  const HeatReadings readings = path.ends_with(".h5")
                                    ? day_readings(path, options)
                                    : sim::calibration::read_heat_readings(path, *machine);
  refuse_unwritable(options, output);
  const plant::MachineChain& chain = sim::model::chain_of(*machine);
  const auto found = sim::calibration::regress(readings, chain, errors_of(options, chain.layout));
  line.end();
  if (!output.empty()) {
    const std::string based_on = sim::input::machine_seen_from(output, machine_path);
    sim::input::write_identified_file(
        output, sim::calibration::identified_file(found, readings, based_on), options.has("force"));
  }
  fmt::print("{}", options.has("json") ? sim::calibration::heat_json(found) + "\n"
                                       : sim::calibration::heat_report(found));
  return kDone;
}

}  // namespace servomill::tools

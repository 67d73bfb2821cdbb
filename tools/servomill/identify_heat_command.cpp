#include <fmt/format.h>

#include <algorithm>

#include "plant/vocabulary/input_error.h"
#include "sim/calibration/heat_regression.h"
#include "sim/input/read_machine.h"
#include "sim/input/read_scenario.h"
#include "sim/model/heat.h"
#include "sim/model/working_day.h"
#include "sim/records/input_file.h"
#include "sim/run/day_course.h"
#include "sim/run/store_day.h"
#include "tools/servomill/command.h"
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

// The case of --case, or the only one with a day.
std::string case_of(const sim::records::InputFile& file, const Options& options) {
  std::vector<std::string> names;
  for (const std::string& name : file.groups("/cases")) {
    if (file.has("/cases/" + name + "/day")) names.push_back(name);
  }
  if (names.empty()) throw InputError({file.path()}, "has no case with a day ([day])");
  if (!options.has("case")) {
    if (names.size() == 1) return names.front();
    throw InputError({"--case"}, fmt::format("is missing; {} has days of {}", file.path(),
                                             fmt::join(names, ", ")));
  }
  const auto& wanted = options.get<std::string>("case");
  if (std::find(names.begin(), names.end(), wanted) != names.end()) return wanted;
  throw InputError({"--case"}, fmt::format("{} has no day of a case '{}'; it has days of {}",
                                           file.path(), wanted, fmt::join(names, ", ")));
}

// Drift that a compensation has already reduced is not that of the machine.
void refuse_compensated(const sim::model::Scenario& scenario, const std::string& name,
                        const std::string& path) {
  const sim::model::CaseSpec* spec = scenario.find_case(name);
  if (spec == nullptr) return;
  for (const sim::model::StrategySpec& strategy : spec->strategies) {
    if (!strategy.entry->corrects_heat) continue;
    throw InputError({path}, fmt::format("case {} has the strategy {}: its drift is the residual "
                                         "of this strategy; name a case without it",
                                         name, strategy.entry->name));
  }
}

HeatReadings readings_of_day(const std::string& path, const Options& options) {
  const sim::records::InputFile file(path);
  const std::string name = case_of(file, options);
  const sim::model::Scenario scenario = sim::input::read_resolved_scenario(
      file.text("/inputs", "resolved"), path + ":/inputs", file.text("/inputs", "program"));
  refuse_compensated(scenario, name, path);
  const auto day = sim::run::read_day(file, "/cases/" + name + "/day");
  HeatReadings out{path, day->sensors, {}};
  if (out.sensors.empty()) throw InputError({path}, "its machine has no temperature sensors");
  for (std::size_t k = 0; k < day->places.size(); ++k) {
    const auto& places = scenario.day->places;
    const auto place = std::find_if(places.begin(), places.end(),
                                    [&](const auto& one) { return one.name == day->places[k]; });
    for (std::size_t n = 0; place != places.end() && n < day->time.size(); ++n) {
      sim::calibration::HeatReading one{place->Q, place->p_ST, {}, {}};
      for (const auto& readings : day->readings) one.T.push_back(readings[n]);
      const auto& drift = day->drift[k][n];
      one.drift = {drift[0], drift[1], drift[2]};
      out.rows.push_back(std::move(one));
    }
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
  if (machine.heat == nullptr) throw InputError({machine_path}, "has no [heat]");
  if (!path.ends_with(".h5") && options.has("case")) {
    throw InputError({"--case"}, "is of result files (DAY.h5) only");
  }
  ProgressLine line(options);
  const HeatReadings readings = path.ends_with(".h5")
                                    ? readings_of_day(path, options)
                                    : sim::calibration::read_heat_readings(path, machine);
  refuse_unwritable(options, output);
  const auto found =
      sim::calibration::regress(readings, machine.chain, errors_of(options, machine.chain.layout));
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

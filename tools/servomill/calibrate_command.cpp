#include <fmt/format.h>

#include "plant/vocabulary/input_error.h"
#include "sim/calibration/identified_errors.h"
#include "sim/calibration/make_up.h"
#include "sim/calibration/report.h"
#include "sim/calibration/suggestions.h"
#include "sim/calibration/write_readings.h"
#include "sim/input/machine_description.h"
#include "sim/model/machine_parts.h"
#include "sim/system/write_file.h"
#include "tools/servomill/progress_line.h"
#include "tools/servomill/readings_options.h"

namespace servomill::tools {

namespace {

namespace po = boost::program_options;
namespace calibration = sim::calibration;

void add_calibrate_options(Options& options) {
  options.add()("machine", po::value<std::string>()->value_name("MACHINE.toml"),
                "measured machine (default: the machine of the readings)");
  options.add()("output,o", po::value<std::string>()->value_name("OUT.toml"),
                "writes the machine with the identified errors, their uncertainty and covariance");
  options.add()("table", po::value<std::string>()->value_name("OUT.csv"),
                "writes every error along the travel with its standard uncertainty");
  options.add()("model", po::value<std::string>()->default_value("identified")->value_name("NAME"),
                "name of the identified error model: [errors.NAME]");
  options.add()("make-up", po::value<std::string>()->value_name("FOLDER"),
                "writes synthetic readings of the machine with the errors of --machine-errors to "
                "this folder, without calibrating");
  options.add()("machine-errors", po::value<std::string>()->value_name("NAME"),
                "error model of the machine file, for --make-up");
  options.add()("seed", po::value<int>()->default_value(1)->value_name("N"),
                "seed of the noise of --make-up");
  options.add()("accept-contradictions",
                "writes the machine even if readings contradict each other");
  options.add()("force,f", "replaces outputs that exist");
  options.add()("json", "prints the report as one JSON object");
  options.add()("quiet,q", "prints only faults and warnings");
}

const plant::ErrorModel& truth_of(const Options& options,
                                  const sim::input::MachineDescription& machine) {
  std::vector<std::string_view> names;
  for (const auto& [name, model] : machine.errors) names.push_back(name);
  if (!options.has("machine-errors")) {
    throw InputError(
        {"--machine-errors"},
        fmt::format("is missing; the machine has the error models {}", fmt::join(names, ", ")));
  }
  const auto& name = options.get<std::string>("machine-errors");
  const auto found = machine.errors.find(name);
  if (found != machine.errors.end()) return found->second;
  throw InputError({"--machine-errors"}, fmt::format("'{}' is not an error model of the machine{}",
                                                     name, did_you_mean(name, names)));
}

void print_suggestions(const std::vector<std::string>& suggestions) {
  if (suggestions.empty()) return;
  fmt::print("\nThese measurements would determine them:\n");
  for (const std::string& suggestion : suggestions) fmt::print("  {}\n", suggestion);
}

}  // namespace

int calibrate_command(const Arguments& arguments) {
  Options options(
      "calibrate", "READINGS.toml [--machine MACHINE.toml] [-o identified.toml]",
      "Finds the geometric errors of a machine from readings of lasers, squares, ball\n"
      "bars, R-tests and touch probes: adjusts all of them at once and reports the\n"
      "uncertainty of each error, errors that the readings cannot separate, and readings\n"
      "that contradict the others. Kinds of readings: sim/readings/README.md.",
      "READINGS.toml");
  add_calibrate_options(options);
  if (!options.parse(arguments)) return kDone;
  const std::string out = output_of(options, "output", ".toml");
  const std::string table = output_of(options, "table", ".csv");
  ProgressLine line(options);
  const std::string file = options.word(), machine_file = measured_machine(options, options.word());
  const sim::input::MachineDescription description =
      sim::input::read_machine_description(machine_file);
  const plant::MachineChain& chain = sim::model::chain_of(*description.machine);
  const auto [lower, upper] = sim::model::travel_of(*description.machine);
  sim::readings::Readings readings = sim::readings::read_readings(
      file, chain, lower, upper,
      options.has("make-up") ? sim::readings::Numbers::ignored : sim::readings::Numbers::required);
  const calibration::CalibrationSettings settings = calibration::read_settings(file, chain.layout);
  if (options.has("make-up")) {
    const auto& folder = options.get<std::string>("make-up");
    calibration::make_up(readings, chain, truth_of(options, description),
                         static_cast<std::uint64_t>(options.get<int>("seed")));
    calibration::write_readings(folder, readings, chain, machine_file, options.has("force"));
    line.end();
    if (!options.has("quiet")) fmt::print("written to {}\n", folder);
    return kDone;
  }
  refuse_unwritable(options, out);
  refuse_unwritable(options, table);
  const calibration::Calibration result =
      calibration::calibrate(std::move(readings), chain, settings);
  const bool json = options.has("json"), prints = !options.has("quiet") && !json;
  const auto suggestions = json || prints ? calibration::suggestions(result, *description.machine)
                                          : std::vector<std::string>();
  line.end();
  if (json) {
    fmt::print("{}\n", calibration::report_json(result, suggestions));
  } else if (prints) {
    fmt::print("{}", calibration::report(result));
    print_suggestions(suggestions);
  }
  for (const std::string& warning : calibration::warnings(result)) {
    fmt::print(stderr, "warning: {}\n", warning);
  }
  if (!table.empty()) {
    sim::system::write_text_file(table, calibration::function_table(result), options.has("force"));
    if (prints) fmt::print("written to {}\n", table);
  }
  if (!out.empty()) {
    if (!options.has("accept-contradictions")) calibration::refuse_contradictions(result);
    calibration::write_identified_errors(out, result, machine_file,
                                         options.get<std::string>("model"), options.has("force"));
    if (prints) fmt::print("written to {}\n", out);
  }
  return kDone;
}

}  // namespace servomill::tools

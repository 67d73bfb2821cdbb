#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <sstream>

#include "plant/vocabulary/input_error.h"
#include "sim/calibration/plan.h"
#include "sim/calibration/write_readings.h"
#include "sim/input/read_machine.h"
#include "tools/servomill/readings_options.h"

namespace servomill::tools {

namespace {

namespace po = boost::program_options;
namespace calibration = sim::calibration;

constexpr double kLongest = 1000.0;  // h

void add_plan_options(Options& options) {
  options.add()("machine,m", po::value<std::string>()->value_name("MACHINE.toml"),
                "machine that is to be measured (default: the one that the readings name)");
  options.add()("instruments",
                po::value<std::string>()->default_value("laser,square,ballbar")->value_name("LIST"),
                "instruments at hand: laser, level, square, ballbar, probe");
  options.add()("hours", po::value<double>()->default_value(8.0)->value_name("H"),
                "time that there is for measuring");
  options.add()("output,o", po::value<std::string>()->value_name("FOLDER"),
                "writes readings.toml there with a CSV file for each set-up, in which the numbers "
                "are missing");
  options.add()("force,f", "replaces outputs that exist");
}

calibration::PlanSettings settings_of(const Options& options) {
  calibration::PlanSettings out;
  std::istringstream words(options.get<std::string>("instruments"));
  for (std::string word; std::getline(words, word, ',');) {
    const auto& names = calibration::kPlanInstruments;
    const auto found = std::find(names.begin(), names.end(), word);
    if (found == names.end()) {
      throw InputError({"--instruments"},
                       fmt::format("'{}' is no instrument of {}{}", word, fmt::join(names, ", "),
                                   did_you_mean(word, names)));
    }
    out.instruments.push_back(static_cast<calibration::PlanInstrument>(found - names.begin()));
  }
  const double hours = options.get<double>("hours");
  if (!(hours > 0.0 && hours <= kLongest)) {
    throw InputError({"--hours"}, fmt::format("must be above 0 and at most {:g}", kLongest));
  }
  out.time = hours * 3600.0;
  return out;
}

}  // namespace

int plan_calibration_command(const Arguments& arguments) {
  Options options(
      "plan-calibration", "[READINGS.toml] --machine MACHINE.toml [-o FOLDER]",
      "Plans what to measure (next): which set-ups of the instruments at hand lower the\n"
      "worst uncertainty of the tip in the working volume most for the time they take,\n"
      "beside what readings say already. Prints the uncertainty to expect, that of\n"
      "lines through the middle of the travel in the same time, and the bound that no\n"
      "plan of these set-ups goes below.",
      "READINGS.toml");
  add_plan_options(options);
  if (!options.parse(arguments)) return kDone;
  const bool has_readings = !options.words().empty();
  const std::string machine_file =
      measured_machine(options, options.words().empty() ? "" : options.word());
  const calibration::PlanSettings settings = settings_of(options);
  const auto machine = sim::input::read_machine_description(machine_file).machine;
  std::optional<sim::readings::Readings> taken;
  if (has_readings) {
    const auto [lower, upper] = travel_of(machine);
    taken = sim::readings::read_readings(options.word(), machine.chain, lower, upper);
  }
  const calibration::Plan plan =
      calibration::plan_calibration(machine, settings, taken ? &*taken : nullptr);
  fmt::print("{}", calibration::report(plan, settings));
  if (options.has("output")) {
    const auto& folder = options.get<std::string>("output");
    std::filesystem::create_directories(folder);
    calibration::write_plan(folder, calibration::planned_readings(plan), machine.chain,
                            machine_file, options.has("force"));
    fmt::print("written to {}\n", folder);
  }
  return kDone;
}

}  // namespace servomill::tools

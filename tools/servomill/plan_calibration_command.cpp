#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <set>
#include <sstream>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/calibration/plan.h"
#include "sim/calibration/write_readings.h"
#include "sim/input/machine_description.h"
#include "sim/model/machine_parts.h"
#include "sim/programs/measuring/measuring_program.h"
#include "sim/system/write_file.h"
#include "tools/servomill/progress_line.h"
#include "tools/servomill/readings_options.h"

namespace servomill::tools {

namespace {

namespace po = boost::program_options;
namespace calibration = sim::calibration;
namespace programs = sim::programs;

constexpr double kLongest = 1000.0;     // h
constexpr double kLargestBall = 200.0;  // mm

void add_plan_options(Options& options) {
  options.add()("machine,m", po::value<std::string>()->value_name("MACHINE.toml"),
                "machine to be measured (default: the machine of the readings)");
  options.add()("instruments",
                po::value<std::string>()->default_value("laser,square,ballbar")->value_name("LIST"),
                "available instruments: laser, level, square, ballbar, probe");
  options.add()("hours", po::value<double>()->default_value(8.0)->value_name("H"),
                "available measuring time");
  options.add()("output,o", po::value<std::string>()->value_name("FOLDER"),
                "folder for readings.toml, a CSV file to be filled in for each set-up, and "
                "measuring programs of the touch probe for --controls");
  options.add()("controls",
                po::value<std::string>()
                    ->default_value("linuxcnc,heidenhain,fanuc,siemens")
                    ->value_name("LIST"),
                "controls for which measuring programs are written");
  options.add()("sphere", po::value<double>()->default_value(25.0)->value_name("D"),
                "diameter of the spheres to be touched, mm");
  options.add()("stylus", po::value<double>()->default_value(6.0)->value_name("D"),
                "diameter of the stylus, mm");
  options.add()("force,f", "replaces outputs that exist");
  options.add()("json", "prints the plan as one JSON object, notes on programs on standard error");
}

calibration::PlanSettings settings_of(const Options& options) {
  calibration::PlanSettings out;
  std::istringstream words(options.get<std::string>("instruments"));
  for (std::string word; std::getline(words, word, ',');) {
    const auto& names = calibration::kPlanInstruments;
    const auto found = std::find(names.begin(), names.end(), word);
    if (found == names.end()) {
      throw InputError({"--instruments"},
                       fmt::format("'{}' is not allowed; must be one of {}{}", word,
                                   fmt::join(names, ", "), did_you_mean(word, names)));
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

std::vector<programs::Dialect> controls_of(const Options& options) {
  std::vector<programs::Dialect> out;
  std::istringstream words(options.get<std::string>("controls"));
  for (std::string word; std::getline(words, word, ',');) {
    const auto& names = programs::kDialects;
    const auto found = std::find(names.begin(), names.end(), word);
    if (found == names.end()) {
      throw InputError({"--controls"},
                       fmt::format("'{}' is no control of {}{}", word, fmt::join(names, ", "),
                                   did_you_mean(word, names)));
    }
    out.push_back(static_cast<programs::Dialect>(found - names.begin()));
  }
  return out;
}

programs::ProbingSettings probing_of(const Options& options) {
  programs::ProbingSettings out;
  for (const auto& [name, to] : {std::pair{"sphere", &out.sphere}, {"stylus", &out.stylus}}) {
    const double value = options.get<double>(name);
    if (!(value > 0.0 && value <= kLargestBall)) {
      throw InputError({fmt::format("--{}", name)},
                       fmt::format("must be above 0 and at most {:g} mm", kLargestBall));
    }
    *to = value * mm;
  }
  return out;
}

// Planning takes seconds to minutes: what cannot be written is refused before it.
void refuse_unwritable_plan(const std::string& folder, bool force) {
  if (!std::filesystem::is_directory(folder)) return;
  sim::system::refuse_unwritable_text((std::filesystem::path(folder) / "readings.toml").string(),
                                      force);
}

// Measuring programs of the spheres that the plan has, and readings.toml of kind touch for them.
void write_programs(const std::string& folder, const sim::readings::Readings& plan,
                    const sim::model::MachineSettings& machine,
                    const programs::ProbingSettings& settings,
                    const std::vector<programs::Dialect>& controls, const Options& options) {
  std::FILE* to = options.has("json") ? stderr : stdout;
  const auto is_sphere = [](const auto& group) {
    return group.kind == sim::readings::Kind::sphere;
  };
  std::set<double> lengths;  // um, of styli
  for (const auto& group : plan.groups) {
    if (is_sphere(group)) lengths.insert(-std::round(group.p_ST.z() / um));
  }
  for (const double length : lengths) {
    const programs::MeasuringMoves moves =
        programs::measuring_moves(plan, machine, settings, length * um);
    for (const std::string& note : moves.notes) fmt::print(to, "note: {}\n", note);
    for (const programs::Dialect dialect : controls) {
      const std::string name = programs::measuring_file(dialect, length * um);
      for (const std::string& clause : programs::write_measuring_program(
               (std::filesystem::path(folder) / name).string(), moves, machine, settings,
               length * um, dialect, options.has("force"))) {
        fmt::print(to, "note: {}: {}\n", name, clause);
      }
    }
    programs::write_touches(folder, moves, machine, settings, length * um, options.has("force"));
    fmt::print(to, "{} touches with a probe of {:g} mm: programs for {}\n", moves.touches,
               length * um / mm, options.get<std::string>("controls"));
  }
}

}  // namespace

int plan_calibration_command(const Arguments& arguments) {
  Options options(
      "plan-calibration", "[READINGS.toml] --machine MACHINE.toml [-o FOLDER]",
      "Plans measurements: selects the set-ups of the available instruments that reduce the\n"
      "worst uncertainty of the TCP in the working volume most in the available time, given the\n"
      "existing readings. Prints the expected uncertainty, that of lines through the middle\n"
      "of the travel in the same time, and the lower bound for all plans of these set-ups.",
      "READINGS.toml");
  add_plan_options(options);
  if (!options.parse(arguments)) return kDone;
  const bool has_readings = !options.words().empty();
  const std::string machine_file =
      measured_machine(options, options.words().empty() ? "" : options.word());
  const calibration::PlanSettings settings = settings_of(options);
  const programs::ProbingSettings probing = probing_of(options);
  const std::vector<programs::Dialect> controls = controls_of(options);
  if (options.has("output")) {
    refuse_unwritable_plan(options.get<std::string>("output"), options.has("force"));
  }
  ProgressLine line(options);
  const auto described = sim::input::read_machine_description(machine_file);
  const sim::model::MachineSettings& machine = *described.machine;
  const plant::MachineChain& chain = sim::model::chain_of(machine);
  std::optional<sim::readings::Readings> taken;
  if (has_readings) {
    const auto [lower, upper] = sim::model::travel_of(machine);
    taken = sim::readings::read_readings(options.word(), chain, lower, upper);
  }
  const calibration::Plan plan =
      calibration::plan_calibration(machine, settings, taken ? &*taken : nullptr);
  line.end();
  const bool json = options.has("json");
  fmt::print("{}", json ? calibration::report_json(plan, settings) + "\n"
                        : calibration::report(plan, settings));
  if (options.has("output")) {
    const auto& folder = options.get<std::string>("output");
    std::filesystem::create_directories(folder);
    const sim::readings::Readings planned = calibration::planned_readings(plan);
    calibration::write_plan(folder, planned, chain, machine_file, options.has("force"));
    write_programs(folder, planned, machine, probing, controls, options);
    if (!json) fmt::print("written to {}\n", folder);
  }
  return kDone;
}

}  // namespace servomill::tools

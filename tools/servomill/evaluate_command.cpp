#include <fmt/format.h>

#include <array>
#include <optional>

#include "plant/vocabulary/input_error.h"
#include "sim/recordings/read_recording.h"
#include "sim/standards/ball_test.h"
#include "sim/standards/circle_test.h"
#include "sim/standards/diagonal_report.h"
#include "sim/standards/error_motion.h"
#include "sim/standards/positioning_log.h"
#include "sim/standards/positioning_report.h"
#include "sim/system/json.h"
#include "sim/system/output_name.h"
#include "sim/system/write_file.h"
#include "tools/servomill/axis_options.h"
#include "tools/servomill/command.h"
#include "tools/servomill/json_list.h"
#include "tools/servomill/progress_line.h"
#include "tools/servomill/readings_options.h"

namespace servomill::tools {

namespace {

namespace po = boost::program_options;
namespace standards = sim::standards;
using standards::Report;

enum class Standard : std::uint8_t { positioning, circles, diagonals, rotation, balls };
constexpr std::array<std::string_view, 5> kStandards = {"iso230-2", "iso230-4", "iso230-6",
                                                        "iso230-7", "iso10791-6"};

void add_evaluate_options(Options& options) {
  const auto text = [](const char* name) { return po::value<std::string>()->value_name(name); };
  options.add()("standard", text("NAME"),
                "iso230-2 (or 2), iso230-4, iso230-6, iso230-7, iso10791-6");
  options.add()("table", text("OUT.csv"), "writes the parameters, one per row");
  options.add()("machine", text("MACHINE.toml"),
                "machine of READINGS.toml (default: its own machine)");
  options.add()("radius", text("R"), "iso230-4: nominal radius of the circle in CSV files, mm");
  options.add()("distance", text("D"),
                "iso230-7: axial distance from the sensors x, y to x2, y2, mm");
  options.add()("period", text("P"),
                "iso230-2: prints the periodic error of this period, mm or deg");
  options.add()("uncertainty", text("LASER.toml"),
                "file with the contributions of device, set-up, temperature and environment: "
                "prints U (k = 2)");
  options.add()(
      "target", text("CHANNEL"),
      "iso230-2, raw logs: channel of the target position, by its name or the end of its name");
  options.add()("position", text("CHANNEL"), "raw logs: channel of the measured position");
  options.add()("unit", text("UNIT"),
                "unit of the measured position, if the log does not state it");
  options.add()("standstill", text("T"), "minimum standstill time of a target (default: 1 s)");
  options.add()("seed", po::value<std::uint64_t>()->default_value(1)->value_name("N"),
                "seed of the Monte Carlo simulation of U");
  options.add()("targets", "also prints the tables of targets and curves");
  options.add()("json", "prints one JSON object per test, numbers in m and rad");
  options.add()("force,f", "replaces OUT.csv if it exists");
}

// "2", "230-2", "ISO230-2" and "iso 230-2" are iso230-2.
Standard standard_of(const Options& options) {
  const Place place{"--standard"};
  if (!options.has("standard")) {
    throw InputError(place, fmt::format("must be given: {}", fmt::join(kStandards, ", ")));
  }
  const auto given = options.get<std::string>("standard");
  std::string word;
  for (const char c : given) {
    if (c != ' ') word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  for (std::size_t k = 0; k < kStandards.size(); ++k) {
    const std::string_view name = kStandards[k];
    const std::string_view number = name.substr(std::string_view("iso").size());
    if (word == name || word == number) return static_cast<Standard>(k);
    if (number.starts_with("230-") && word == number.substr(std::string_view("230-").size())) {
      return static_cast<Standard>(k);
    }
  }
  throw InputError(place, fmt::format("unknown standard '{}'{}; known are {}", given,
                                      did_you_mean(word, kStandards), fmt::join(kStandards, ", ")));
}

double radius_of(const Options& options) {
  const auto radius = positive_option(options, "radius", sim::config::kLength, "mm");
  if (!radius) {
    throw InputError({"--radius"},
                     "must be given: the nominal radius of the circle, such as "
                     "\"100 mm\"");
  }
  return *radius;
}

std::optional<standards::UncertaintyInput> uncertainty_of(const Options& options,
                                                          Standard standard) {
  if (!options.has("uncertainty")) return std::nullopt;
  const auto& file = options.get<std::string>("uncertainty");
  if (standard != Standard::positioning) {
    throw InputError({"--uncertainty"}, "states U of the parameters of iso230-2 only");
  }
  standards::UncertaintyInput out{standards::read_contributions(file), {}};
  out.settings.seed = options.get<std::uint64_t>("seed");
  return out;
}

Report with_period(Report report, const standards::PositioningFile& file, const Options& options) {
  const auto quantity = file.test.angular ? sim::config::kAngle : sim::config::kLength;
  const auto period = positive_option(options, "period", quantity, bare_unit(quantity));
  if (!period) return report;
  if (const auto why = standards::why_no_period(file.test, *period)) {
    throw InputError({"--period"}, fmt::format("{}: {}", file.name, *why));
  }
  standards::add_periodic_error(file.test, *period, report);
  return report;
}

std::vector<Report> positioning_reports(const std::vector<standards::PositioningFile>& files,
                                        Standard standard, const Options& options) {
  const auto uncertainty = uncertainty_of(options, standard);
  if (standard == Standard::diagonals) return {standards::diagonal_report(files)};
  std::vector<Report> out;
  out.reserve(files.size());
  for (const standards::PositioningFile& file : files) {
    out.push_back(with_period(standards::positioning_report(file, uncertainty), file, options));
  }
  return out;
}

// A test from a raw log where channels are named, else from a table or list of readings.
standards::PositioningFile positioning_file(const std::string& file, const Options& options) {
  if (options.has("target") != options.has("position")) {
    throw InputError({options.has("target") ? "--position" : "--target"},
                     "must be given, too: a raw log is read from both channels");
  }
  if (options.has("target")) {
    standards::LogSettings settings;
    settings.target = options.get<std::string>("target");
    settings.position = options.get<std::string>("position");
    if (options.has("unit")) settings.unit = options.get<std::string>("unit");
    settings.standstill =
        positive_option(options, "standstill", sim::config::kTime, "s").value_or(1.0);
    return standards::positioning_of(sim::recordings::read_recording(file), settings);
  }
  return standards::read_positioning(file);
}

// Reports of tables, one test a file.
std::vector<Report> reports_of_tables(const std::vector<std::string>& files, Standard standard,
                                      const Options& options) {
  std::vector<Report> out;
  std::vector<standards::PositioningFile> runs;
  for (const std::string& file : files) {
    switch (standard) {
      case Standard::positioning:
      case Standard::diagonals:
        runs.push_back(positioning_file(file, options));
        break;
      case Standard::circles:
        out.push_back(standards::circle_report(standards::read_circle(file, radius_of(options))));
        break;
      case Standard::rotation:
        out.push_back(standards::rotation_report(standards::read_rotation(
            file, positive_option(options, "distance", sim::config::kLength, "mm").value_or(0.0))));
        break;
      case Standard::balls:
        out.push_back(standards::ball_report(standards::read_ball(file)));
        break;
    }
  }
  return runs.empty() ? out : positioning_reports(runs, standard, options);
}

// True for the groups that a standard evaluates.
bool belongs_to(const sim::readings::Group& group, Standard standard) {
  using sim::readings::Kind;
  if (standard == Standard::positioning) {
    return group.kind == Kind::positioning && group.axis.has_value();
  }
  if (standard == Standard::diagonals) return group.kind == Kind::positioning && !group.axis;
  return group.kind == (standard == Standard::circles ? Kind::circle : Kind::r_test);
}

// Reports of the groups of a file of readings that the standard is for.
std::vector<Report> reports_of_groups(const std::string& file, Standard standard,
                                      const Options& options) {
  if (standard == Standard::rotation) {
    throw InputError({file},
                     "iso230-7 is evaluated from a CSV file of sensors; see "
                     "sim/standards/README.md");
  }
  const MeasuredMachine machine = read_measured_machine(options, file);
  const auto all = sim::readings::read_readings(file, machine.chain, machine.lower, machine.upper);
  const JointLayout& layout = machine.chain.layout;
  std::vector<Report> out;
  std::vector<standards::PositioningFile> runs;
  for (const sim::readings::Group& group : all.groups) {
    if (!belongs_to(group, standard)) continue;
    if (group.kind == sim::readings::Kind::positioning) {
      runs.push_back(standards::positioning_of(group, layout));
    } else if (group.kind == sim::readings::Kind::r_test) {
      out.push_back(standards::ball_report(standards::ball_of(group)));
    } else {
      for (const auto& test : standards::circles_of(group, layout)) {
        out.push_back(standards::circle_report(test));
      }
    }
  }
  if (!runs.empty()) return positioning_reports(runs, standard, options);
  if (out.empty()) {
    throw InputError(
        {file}, fmt::format("has no group for {}", kStandards[static_cast<std::size_t>(standard)]));
  }
  return out;
}

std::vector<Report> reports_of(const Options& options, Standard standard) {
  const std::vector<std::string> files = options.words();
  if (files.empty()) {
    throw InputError({"servomill evaluate"}, "expected files of readings; see --help");
  }
  const bool toml = files.front().ends_with(".toml");
  if (toml && files.size() > 1) {
    throw InputError({files[1]}, "several files are CSV files, one test each");
  }
  return toml ? reports_of_groups(files.front(), standard, options)
              : reports_of_tables(files, standard, options);
}

void print_reports(const std::vector<Report>& reports, const Options& options) {
  if (options.has("json")) {
    JsonList list;
    for (const Report& report : reports) list.add(standards::json(report));
    list.end();
    return;
  }
  for (const Report& report : reports) {
    if (&report != &reports.front()) fmt::print("\n");
    fmt::print("{}", standards::printed(report, options.has("targets")));
  }
}

}  // namespace

int evaluate_command(const Arguments& arguments) {
  Options options(
      "evaluate", "READINGS... --standard iso230-2|iso230-4|iso230-6|iso230-7|iso10791-6 [--json]",
      "Prints the parameters of a test as its standard defines them, from readings of a real\n"
      "machine: CSV files with one test each, or the groups of one READINGS.toml. Columns and\n"
      "results: sim/standards/README.md.",
      "READINGS");
  add_evaluate_options(options);
  if (!options.parse(arguments)) return kDone;
  const Standard standard = standard_of(options);
  const bool force = options.has("force");
  if (options.has("table")) {
    sim::system::output_target(options.get<std::string>("table"), sim::system::existing_of(force));
  }
  ProgressLine line(options);
  const std::vector<Report> reports = reports_of(options, standard);
  line.end();
  print_reports(reports, options);
  if (options.has("table")) {
    sim::system::write_text_file(options.get<std::string>("table"), standards::csv(reports), force);
    if (!options.has("json")) fmt::print("written to {}\n", options.get<std::string>("table"));
  }
  return kDone;
}

}  // namespace servomill::tools

#include <fmt/format.h>

#include <array>
#include <optional>

#include "plant/vocabulary/input_error.h"
#include "sim/standards/positioning_report.h"
#include "sim/system/json.h"
#include "sim/system/output_name.h"
#include "sim/system/write_file.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

namespace {

namespace po = boost::program_options;
using sim::standards::Report;

constexpr std::array<std::string_view, 1> kStandards = {"iso230-2"};

void add_evaluate_options(Options& options) {
  const auto text = [](const char* name) { return po::value<std::string>()->value_name(name); };
  options.add()("standard", text("NAME"), "iso230-2 (or 230-2, 2)");
  options.add()("table", text("OUT.csv"), "writes the parameters, one a row");
  options.add()("uncertainty", text("LASER.toml"),
                "contributions of device, set-up, temperature and environment: prints U (k = 2)");
  options.add()("seed", po::value<std::uint64_t>()->default_value(1)->value_name("N"),
                "of the Monte Carlo simulation of U");
  options.add()("targets", "prints the table of the targets, too");
  options.add()("json", "prints one JSON object a test, numbers in m and rad");
  options.add()("force,f", "replaces OUT.csv if it exists");
}

// "2", "230-2", "ISO230-2" and "iso 230-2" are iso230-2.
std::string_view standard_of(const Options& options) {
  const Place place{"--standard"};
  if (!options.has("standard")) {
    throw InputError(place, fmt::format("must be given: {}", fmt::join(kStandards, ", ")));
  }
  const auto given = options.get<std::string>("standard");
  std::string word;
  for (const char c : given) {
    if (c != ' ') word += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  }
  for (const std::string_view name : kStandards) {
    const std::string_view number = name.substr(std::string_view("iso").size());
    if (word == name || word == number) return name;
    if (number.starts_with("230-") && word == number.substr(std::string_view("230-").size())) {
      return name;
    }
  }
  throw InputError(place, fmt::format("'{}' is not known{}; known are {}", given,
                                      did_you_mean(word, kStandards), fmt::join(kStandards, ", ")));
}

}  // namespace

int evaluate_command(const Arguments& arguments) {
  Options options("evaluate", "READINGS.csv --standard iso230-2 [--json]",
                  "Evaluates readings of a test as its standard has it.", "READINGS.csv");
  add_evaluate_options(options);
  if (!options.parse(arguments)) return kDone;
  const std::string file = options.word();
  standard_of(options);
  const bool force = options.has("force");
  if (options.has("table")) {
    sim::system::output_target(options.get<std::string>("table"), sim::system::existing_of(force));
  }
  std::optional<sim::standards::UncertaintyInput> uncertainty;
  if (options.has("uncertainty")) {
    uncertainty.emplace(
        sim::standards::read_contributions(options.get<std::string>("uncertainty")));
    uncertainty->settings.seed = options.get<std::uint64_t>("seed");
  }
  const std::vector<Report> reports = {
      sim::standards::positioning_report(sim::standards::read_positioning(file), uncertainty)};
  for (const Report& report : reports) {
    fmt::print("{}", options.has("json") ? sim::standards::json(report) + "\n"
                                         : sim::standards::printed(report, options.has("targets")));
  }
  if (options.has("table")) {
    sim::system::write_text_file(options.get<std::string>("table"), sim::standards::csv(reports),
                                 force);
    if (!options.has("json")) fmt::print("written to {}\n", options.get<std::string>("table"));
  }
  return kDone;
}

}  // namespace servomill::tools

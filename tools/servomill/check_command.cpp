#include <fmt/format.h>

#include <memory>

#include "plant/vocabulary/input_error.h"
#include "sim/programs/canonical_moves.h"
#include "sim/programs/program_survey.h"
#include "sim/system/json.h"
#include "tools/servomill/command.h"
#include "tools/servomill/json_list.h"
#include "tools/servomill/program_options.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

void declare(Options& options) {
  const auto texts = [](const char* name) {
    return po::value<std::vector<std::string>>()->value_name(name);
  };
  options.add()("set", texts("KEY=VALUE"), "changes a key of the scenarios, as for servomill run");
  add_program_options(options);
  options.add()(
      "machine", po::value<std::string>()->value_name("M.toml"),
      "machine that runs the programs: needed for the cycle time (v_max, a_max and j_max of its "
      "axes are sufficient), for travel limits, and for G43.4, G43.5, G53.1 and G68.2");
  options.add()("work-offset", texts("X=10,Y=-5"),
                "programs: position of G54 in the machine, mm and deg; G55:X=10,R=30 for another "
                "work offset with a rotation");
  options.add()("tool-length", texts("1=50"),
                "programs: length of tool 1 (in mm, or \"1=50 mm\"), overrides --tools");
  options.add()("json", "prints a JSON list, one object per FILE");
  options.add()("quiet,q", "prints only faults");
}

std::string to_json(const std::vector<Fault>& faults) {
  std::vector<std::string> out;
  for (const Fault& fault : faults) {
    out.push_back(sim::system::JsonObject()
                      .text("file", fault.place.file)
                      .integer("line", fault.place.line)
                      .integer("column", fault.place.column)
                      .text("message", fault.message)
                      .line());
  }
  return sim::system::json_list(out);
}

// @return number of faults
std::size_t check(const std::string& path, const Options& options,
                  sim::programs::ProgramInputs inputs, JsonList& list, ProgressLine& line) {
  inputs.trials = std::make_shared<controllers::SharedTrials>();
  sim::programs::CheckedFile checked = sim::programs::check_file(path, options.list("set"), inputs);
  const bool json = options.has("json");
  std::optional<sim::programs::ProgramSurvey> survey;
  const bool needs_survey = json || !options.has("quiet") || options.has("machine");
  if (sim::programs::is_program(path) && needs_survey) {
    survey = sim::programs::survey_program(
        {path, inputs, options.list("work-offset"), options.list("tool-length")});
    checked.faults.insert(checked.faults.end(), survey->outside_travel.begin(),
                          survey->outside_travel.end());
  }
  const std::size_t faults = checked.faults.size();
  const auto hidden = line.hidden();
  if (json) {
    list.add(sim::system::JsonObject()
                 .text("file", path)
                 .raw("faults", to_json(checked.faults))
                 .raw("warnings", to_json(checked.warnings))
                 .text_or_null("not_run", checked.not_run)
                 .raw("program", survey ? sim::programs::to_json(*survey) : "null")
                 .line());
    return faults;
  }
  for (const Fault& warning : checked.warnings) {
    fmt::print(stderr, "{}: warning: {}\n", to_string(warning.place), warning.message);
  }
  for (const Fault& fault : checked.faults) fmt::print(stderr, "{}\n", to_string(fault));
  if (options.has("quiet")) return faults;
  if (faults == 0) fmt::print("{}: no faults\n", path);
  if (!checked.not_run.empty()) fmt::print("{}: not run: {}\n", path, checked.not_run);
  if (survey) fmt::print("{}", sim::programs::to_text(*survey));
  return faults;
}

}  // namespace

int check_command(const Arguments& arguments) {
  Options options(
      "check", "FILE... [--set KEY=VALUE]... [--tools TABLE] [--machine M.toml] [--json]",
      "Checks scenarios and machines (.toml), cutter locations (.cls, .apt, .csv) and programs\n"
      "(all other files) and prints every error with file:line:column. Scenarios are prepared as\n"
      "for a run, up to the first tick, at every point of their sweep. Runs from which strategies\n"
      "learn are not executed; their number is printed.\n"
      "\n"
      "For each program it prints units, work offsets, tools, extent, cycle time, the controls\n"
      "that accept it unchanged, and for every other control the first line that it refuses.\n"
      "Positions are known if the program specifies them; machine coordinates are known if, in\n"
      "addition, --work-offset or --parameter-file and the tool lengths are given. A value that\n"
      "needs a missing option (--additional-offset for G54.1 P, --machine for G43.4, G68.2 and\n"
      "M140 MB MAX) is printed as unknown, with the name of the option. The extent includes the\n"
      "ends of all moves and the extreme points of arcs. The cycle time is that of the motion,\n"
      "planned as in a run.",
      "FILE");
  declare(options);
  add_plugin_option(options);
  if (!options.parse(arguments)) return kDone;
  load_plugins(options);
  if (options.words().empty()) throw InputError({"servomill check"}, "needs a FILE; see --help");
  const sim::programs::ProgramInputs inputs = program_inputs(options);
  JsonList list;
  ProgressLine line(options);
  Stage files("files", static_cast<double>(options.words().size()), Steps::unlike);
  std::size_t faults = 0;
  for (const std::string& path : options.words()) {
    faults += check(path, options, inputs, list, line);
    files.advance();
  }
  line.end();
  if (options.has("json")) list.end();
  return faults == 0 ? kDone : kInputWrong;
}

}  // namespace servomill::tools

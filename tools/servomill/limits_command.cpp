#include <fmt/format.h>

#include <optional>
#include <string>

#include "plant/vocabulary/input_error.h"
#include "sim/input/machine_description.h"
#include "sim/limits/limit_check.h"
#include "sim/recordings/read_recording.h"
#include "tools/servomill/axis_options.h"
#include "tools/servomill/command.h"
#include "tools/servomill/program_options.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

void declare_limits_options(Options& options) {
  const auto text = [](const char* name) { return po::value<std::string>()->value_name(name); };
  const auto texts = [](const char* name) {
    return po::value<std::vector<std::string>>()->value_name(name);
  };
  options.add()("machine,m", text("M.toml"),
                "machine with the limits v_max, a_max, j_max of its axes");
  options.add()("channel", texts("\"X=NAME [mm]\""),
                "channel of an axis, with its unit if the log states none: a position, a velocity "
                "(mm/s) or an acceleration; default: recognised by name");
  options.add()("line", text("NAME"), "channel of the program line; default: recognised by name");
  options.add()("case", text("NAME"), "case to be checked, for a result file with several cases");
  options.add()(
      "period", text("\"1 ms\""),
      "time between samples, for a log that only numbers them (halsampler); bare numbers in ms");
  options.add()("time-unit", text("us"), "unit of times without a unit in the log; default: s");
  options.add()(
      "window", text("\"5 ms\""),
      "averaging window, bare numbers in ms; default: the shortest window in which the resolution "
      "of the log causes at most 5 % of the limit, not longer than 100 ms or the log");
  options.add()(
      "resolution", text("\"1 um\""),
      "resolution of samples, bare numbers in um (of rotary axes in urad, of velocities per "
      "s); default: the step of which all samples are multiples");
  options.add()("program,p", text("PROGRAM"),
                "program that was recorded: its path is compared, too; the log begins at the "
                "machine position before the program");
  options.add()("tolerance", text("\"20 um\""),
                "tolerance of the path, bare numbers in um; default: P of G64; for G64 without P "
                "nc.path_tolerance of the machine file; for G61 0.1 um");
  add_program_options(options);
  add_placement_options(options);
  options.add()("set", texts("KEY=VALUE"), "changes a key of the machine");
  options.add()(
      "top", po::value<int>()->default_value(5)->value_name("N"),
      "lists the N largest violations of each limit, and the N lines with the largest deviation");
  options.add()("json", "prints one JSON object");
  options.add()("quiet,q", "prints only faults");
}

std::optional<sim::limits::ProgramRequest> program_request(const Options& options) {
  const auto tolerance = positive_option(options, "tolerance", sim::config::kLength, "um");
  if (options.has("program")) {
    return sim::limits::ProgramRequest{
        program_placement(options, options.get<std::string>("program")), tolerance};
  }
  for (const char* name : {"tolerance", "tools", "parameter", "parameter-file", "subs", "reader",
                           "decimal-point", "feed", "additional-offset", "ignore-code",
                           "block-delete", "max-jumps", "work-offset", "tool-length", "start"}) {
    if (options.has(name)) throw InputError({fmt::format("--{}", name)}, "needs --program PROGRAM");
  }
  return std::nullopt;
}

}  // namespace

int limits_command(const Arguments& arguments) {
  Options options(
      "limits",
      "LOG --machine M.toml [--program PROGRAM] [--channel \"X=NAME [mm]\"]... [--period \"1 ms\"]",
      "Checks a recorded motion against the limits of a machine: velocity, acceleration and jerk\n"
      "of each axis, the largest factor over the limit, when, in which line and how often. LOG is\n"
      "a recording of any known format (halsampler, halscope, CSV, HDF5, ...: see servomill\n"
      "recording).\n"
      "\n"
      "Derivatives are means over windows: divided differences of the samples. If the motion is\n"
      "within its limits, these cannot exceed the limits, whatever the sampling. The possible\n"
      "effect of the resolution of the log is printed; a violation counts only if it is larger.\n"
      "\n"
      "With --program the motion is compared with the programmed path, line by line: the\n"
      "deviation from the path and the distance from the corners are checked against the\n"
      "tolerance.\n"
      "\n"
      "Exit status 1: a limit or a tolerance is exceeded, or a limit is not evaluated because no\n"
      "window fits into the log.",
      "LOG");
  declare_limits_options(options);
  if (!options.parse(arguments)) return kDone;
  if (!options.has("machine")) {
    throw InputError({"servomill limits"}, "needs --machine M.toml; see --help");
  }
  const auto text_of = [&](const char* name) {
    return options.has(name) ? options.get<std::string>(name) : std::string();
  };
  sim::limits::LimitRequest request;
  request.log.channels = options.list("channel");
  request.log.line_channel = text_of("line");
  request.log.case_name = text_of("case");
  request.log.period = positive_option(options, "period", sim::config::kTime, "ms");
  request.window = positive_option(options, "window", sim::config::kTime, "ms");
  request.resolution = positive_option(options, "resolution", sim::config::kLength, "um");
  request.program = program_request(options);
  const int top = options.get<int>("top");
  if (top < 0) throw InputError({"--top"}, "must be >= 0");
  const auto machine =
      sim::input::read_machine_description(options.get<std::string>("machine"), options.list("set"))
          .machine;
  ProgressLine line(options);
  const auto recording = sim::recordings::read_recording(options.word(), text_of("time-unit"));
  const sim::limits::LimitReport report = sim::limits::check_limits(recording, *machine, request);
  line.end();
  const auto shown = static_cast<std::size_t>(top);
  if (options.has("json")) {
    fmt::print("{}\n", sim::limits::to_json(report, shown));
  } else if (!options.has("quiet")) {
    fmt::print("{}", sim::limits::to_text(report, shown));
  }
  return report.is_exceeded() || report.lacks_evaluation() ? kMachineStopped : kDone;
}

}  // namespace servomill::tools

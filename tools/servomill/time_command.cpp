#include <fmt/format.h>

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "sim/config/written_number.h"
#include "sim/programs/cycle_time/cycle_time.h"
#include "sim/system/write_file.h"
#include "tools/servomill/axis_options.h"
#include "tools/servomill/command.h"
#include "tools/servomill/json_list.h"
#include "tools/servomill/program_options.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;
using sim::programs::CycleTimeReport;

void declare_time_options(Options& options) {
  const auto text = [](const char* name) { return po::value<std::string>()->value_name(name); };
  const auto texts = [](const char* name) {
    return po::value<std::vector<std::string>>()->value_name(name);
  };
  options.add()("machine,m", text("M.toml"),
                "machine that runs the program; v_max, a_max and j_max of its axes are sufficient");
  options.add()("by", text("line|tool|section"),
                "table to print; default: tools and sections if there are several, and lines");
  options.add()("top", po::value<int>()->default_value(10)->value_name("N"),
                "prints the N lines that take longest");
  options.add()("raise", text("PERCENT"),
                "plans the program again with each limit raised in turn by PERCENT, such as 10, "
                "and prints the time saved");
  options.add()("csv", text("FILE.csv"),
                "writes all rows of the table selected by --by (default: line)");
  add_program_options(options);
  add_placement_options(options);
  options.add()("feed-override", po::value<double>()->value_name("0.5"), "factor on all feeds");
  options.add()("set", texts("KEY=VALUE"),
                "changes a key of the machine, such as axis.X.a_max=\"2 m/s^2\", or of the "
                "scenario, as for servomill run");
  options.add()("case", texts("NAME"), "scenarios: only this case");
  options.add()("threads,j", po::value<int>()->default_value(0)->value_name("N"),
                "threads of --raise (default: one per core)");
  options.add()(
      "json",
      "prints the result as JSON, for a scenario a list of motions; unknown values are null");
  options.add()("force,f", "replaces the file of --csv if it exists");
  options.add()("quiet,q", "prints only warnings and faults");
  add_plugin_option(options);
}

// A share above 0, given in percent: "10", "10 %"; 0 without the option.
double raise_of(const Options& options) {
  if (!options.has("raise")) return 0.0;
  std::string text = options.get<std::string>("raise");
  while (!text.empty() && (text.back() == '%' || text.back() == ' ')) text.pop_back();
  const double percent = sim::config::number_of(text);
  constexpr double kMax = 1000.0;
  if (percent > 0.0 && percent <= kMax) return percent / 100.0;
  throw InputError({"--raise " + options.get<std::string>("raise")},
                   fmt::format("must be a number of percent, > 0 and <= {:g}", kMax));
}

sim::programs::CycleTimeRequest request_of(const Options& options) {
  if (!options.has("machine")) {
    throw InputError({"servomill time"}, "needs --machine M.toml; see --help");
  }
  sim::programs::CycleTimeRequest request;
  request.placement = program_placement(options, options.word());
  if (options.has("feed-override")) {
    request.feed_override = positive_number(options, "feed-override");
  }
  request.raise = raise_of(options);
  request.threads = thread_count(options);
  return request;
}

void refuse_options_of_programs(const Options& options) {
  for (const char* name :
       {"machine", "tools", "parameter", "parameter-file", "subs", "reader", "decimal-point",
        "feed", "additional-offset", "ignore-code", "block-delete", "max-jumps", "work-offset",
        "tool-length", "start", "feed-override"}) {
    if (!options.has(name)) continue;
    throw InputError({fmt::format("--{}", name)},
                     "is for programs; a scenario has its own, see --set");
  }
}

std::vector<CycleTimeReport> reports_of(const Options& options) {
  if (options.word().ends_with(".toml")) {
    refuse_options_of_programs(options);
    return sim::programs::scenario_cycle_times(options.word(), options.list("set"),
                                               options.list("case"), raise_of(options),
                                               thread_count(options));
  }
  if (options.has("case")) throw InputError({"--case"}, "is for scenarios");
  sim::programs::CycleTimeRequest request = request_of(options);
  std::vector<CycleTimeReport> out;
  out.push_back(sim::programs::cycle_time(request));
  return out;
}

void print_warnings(const std::vector<CycleTimeReport>& reports) {
  std::set<std::string> printed;
  for (const CycleTimeReport& report : reports) {
    for (const Fault& warning : report.warnings) {
      const std::string line =
          fmt::format("{}: warning: {}", to_string(warning.place), warning.message);
      if (printed.insert(line).second) fmt::print(stderr, "{}\n", line);
    }
  }
}

// The motion of a program, or the list of those of a scenario.
void print_json(const std::vector<CycleTimeReport>& reports,
                const sim::programs::TimeReportForm& form, bool is_list) {
  if (!is_list) {
    fmt::print("{}\n", sim::programs::to_json(reports.front(), form));
    return;
  }
  JsonList list;
  for (const CycleTimeReport& report : reports) list.add(sim::programs::to_json(report, form));
  list.end();
}

}  // namespace

int time_command(const Arguments& arguments) {
  Options options(
      "time",
      "PROGRAM --machine M.toml [--by line|tool|section] [--raise PERCENT] [--csv FILE] [--json]",
      "Prints the cycle time of a program, whose motion is planned as in a run, without servo\n"
      "loops. The time is split into feed, rapid and dwell; by the limits that bound the motion\n"
      "(programmed feed, velocity, acceleration, jerk, corners within the tolerance), axis by\n"
      "axis; by tools and sections (MSG comments); and by line, longest first. --raise prints\n"
      "what higher limits save.\n"
      "\n"
      "A limit bounds the motion while it is used to 90 % or more, and to a larger fraction than\n"
      "any other limit. It is counted as a corner if its acceleration or jerk comes from rounding\n"
      "between straight blocks.\n"
      "\n"
      "Unknown times are listed and never counted as 0: moves from positions that nothing\n"
      "specifies (--start specifies the first), stops and, unless the machine file has\n"
      "nc.tool_change_time_s and nc.spindle_time_s, tool changes and spindle speed changes.\n"
      "\n"
      "For a SCENARIO.toml each motion of its cases is timed, with the program as their\n"
      "strategies rewrite it.",
      "PROGRAM|SCENARIO.toml");
  declare_time_options(options);
  if (!options.parse(arguments)) return kDone;
  load_plugins(options);
  sim::programs::TimeReportForm form;
  if (options.has("by")) {
    form.table = static_cast<sim::programs::TimeTable>(
        choice_option(options, "by", sim::programs::kTimeTables));
  }
  const int top = options.get<int>("top");
  if (top < 0) throw InputError({"--top"}, "must be >= 0");
  form.top = static_cast<std::size_t>(top);
  const std::string csv = output_of(options, "csv", ".csv");
  ProgressLine line(options);
  const std::vector<CycleTimeReport> reports = reports_of(options);
  refuse_unwritable(options, csv);  // behind the faults of what is read
  line.end();
  print_warnings(reports);
  if (!csv.empty()) {
    if (reports.size() > 1) {
      throw InputError({"--csv"}, "takes one motion; choose a case with --case");
    }
    const auto table = form.table.value_or(sim::programs::TimeTable::line);
    sim::system::write_text_file(csv, sim::programs::to_csv(reports.front(), table),
                                 options.has("force"));
  }
  if (options.has("json")) {
    print_json(reports, form, options.word().ends_with(".toml"));
  } else if (!options.has("quiet")) {
    for (std::size_t k = 0; k < reports.size(); ++k) {
      fmt::print("{}{}", k == 0 ? "" : "\n", sim::programs::to_text(reports[k], form));
    }
  }
  return kDone;
}

}  // namespace servomill::tools

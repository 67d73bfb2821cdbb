#include "tools/servomill/post_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "sim/config/option_value.h"
#include "tools/servomill/axis_options.h"

namespace servomill::tools {
namespace {

namespace po = boost::program_options;

// A whole number within bounds, both included.
int whole_option(const Options& options, const std::string& name, int min, int max) {
  const int value = options.get<int>(name);
  if (value >= min && value <= max) return value;
  throw InputError({"--" + name}, fmt::format("{}; must be >= {} and <= {}", value, min, max));
}

// A quantity from 0.001 to 1e9 of its unit.
double bounded_option(const Options& options, const std::string& name,
                      sim::config::Quantity quantity, std::string_view unit) {
  constexpr double kMin = 1e-3, kMax = 1e9;
  const double value = *quantity_option(options, name, quantity, unit);
  const double in_unit = value / sim::config::parse_unit(unit).unit->factor;
  if (in_unit >= kMin && in_unit <= kMax) return value;
  throw InputError({"--" + name}, fmt::format("'{}' must be >= {:g} and <= {:g} {}",
                                              options.get<std::string>(name), kMin, kMax, unit));
}

// "110 mm" of every tool, "1=50" of one.
void take_tool_lengths(const Options& options, sim::programs::PostRequest& request) {
  for (const std::string& text : options.list("tool-length")) {
    if (text.find('=') != std::string::npos) {
      request.tool_lengths.push_back(text);
      continue;
    }
    const sim::config::ScaledText length =
        sim::config::scale_option(text, sim::config::kLength, "mm");
    const std::string fault = !length.complaint.empty() ? length.complaint
                              : length.si < 0.0         ? "must be >= 0"
                                                        : "";
    if (!fault.empty()) {
      throw InputError({"--tool-length"},
                       fmt::format("'{}'{} {}", text, fault.front() == '\'' ? ":" : "", fault));
    }
    request.tool_length = length.si;
  }
}

// "10,0,-5.5" in mm
Eigen::Vector3d work_offset_of(const std::string& text) {
  std::array<double, 3> values{};
  std::size_t from = 0, n = 0;
  for (; n < values.size() && from <= text.size(); ++n) {
    const std::size_t end = std::min(text.find(',', from), text.size());
    const auto value = sim::config::scale_option(std::string_view(text).substr(from, end - from),
                                                 sim::config::kLength, "mm");
    if (!value.complaint.empty()) break;
    values[n] = value.si;
    from = end + 1;
  }
  if (n < values.size() || from <= text.size()) {
    throw InputError({"--work-offset " + text},
                     "must be three lengths, such as 10,0,-5.5 (in mm) or \"10 mm,0 mm,-5.5 mm\"");
  }
  return {values[0], values[1], values[2]};
}

// Options that contradict each other.
void refuse_contradictions(const Options& options) {
  if (!options.has("machine")) {
    throw InputError({"servomill post"}, "needs --machine M.toml; see --help");
  }
  constexpr std::array<std::array<const char*, 2>, 2> kPairs = {
      {{"tcp", "classical"}, {"tools", "tool-length"}}};
  for (const auto& [a, b] : kPairs) {
    if (!options.has(a) || !options.has(b)) continue;
    throw InputError({"servomill post"}, fmt::format("--{} and --{} exclude each other", a, b));
  }
}

void read_approach(const Options& options, sim::programs::PostRequest& request) {
  constexpr std::array<std::string_view, 2> kApproaches = {"safe", "direct"};
  request.options.approach =
      static_cast<controllers::Approach>(choice_option(options, "approach", kApproaches));
  if (request.options.approach == controllers::Approach::direct) {
    for (const char* name : {"clearance", "retract"}) {
      if (!options.has(name)) continue;
      throw InputError({std::string("--") + name}, "has no effect with --approach direct");
    }
  }
  if (options.has("clearance")) {
    request.options.safe.clearance =
        bounded_option(options, "clearance", sim::config::kLength, "mm");
  }
  request.retract_Z = retract_option(options);
}

}  // namespace

sim::programs::PostRequest post_request(const Options& options) {
  refuse_contradictions(options);
  sim::programs::PostRequest request;
  request.cl_file = options.word();
  request.machine_file = options.get<std::string>("machine");
  request.changes = options.list("set");
  if (options.has("tools")) request.tool_table = options.get<std::string>("tools");
  take_tool_lengths(options, request);
  if (options.has("start")) request.start = options.get<std::string>("start");
  controllers::PostOptions& post = request.options;
  post.mode = options.has("tcp")         ? controllers::PostMode::tip
              : options.has("classical") ? controllers::PostMode::locations
                                         : controllers::PostMode::joints;
  post.tolerance.tip = bounded_option(options, "tolerance", sim::config::kLength, "um");
  post.tolerance.axis = bounded_option(options, "axis-tolerance", sim::config::kAngle, "urad");
  if (options.has("feed")) {
    post.feed = bounded_option(options, "feed", sim::config::kVelocity, "mm/min");
  }
  post.rotary_rate =
      bounded_option(options, "rotary-feed", sim::config::kAngularVelocity, "deg/min");
  if (options.has("work-offset")) {
    request.work_offset = work_offset_of(options.get<std::string>("work-offset"));
  }
  post.work_system = whole_option(options, "work-system", 54, 59) - 53;
  if (options.has("tool")) {
    post.tool = whole_option(options, "tool", 0, 99999);
    request.has_no_tool = post.tool == 0;
  }
  read_approach(options, request);
  return request;
}

void add_post_options(Options& options) {
  options.add()("machine,m", po::value<std::string>()->value_name("M.toml"), "machine file");
  options.add()("set", po::value<std::vector<std::string>>()->value_name("KEY=VALUE"),
                "changes a key of the machine, such as axis.A.centre_mm=[0,0,-150]");
  options.add()("output,o", po::value<std::string>()->value_name("OUT.ngc"),
                "program; - for standard output. Default: PART.ngc in the current folder");
  options.add()("tolerance",
                po::value<std::string>()->default_value("1 um")->value_name("\"1 um\""),
                "largest deviation of the TCP from the straight path (um): half for the chords "
                "between inserted points, half for the NC to round corners (G64 P)");
  options.add()("axis-tolerance",
                po::value<std::string>()->default_value("100 urad")->value_name("\"100 urad\""),
                "largest deviation of the tool axis from its great circle (urad)");
  options.add()("classical", "one block per location, without inserted points");
  options.add()("tcp", "for an NC with tool-centre-point control: G43.4, X Y Z are the TCP");
  options.add()("work-offset", po::value<std::string>()->value_name("X,Y,Z"),
                "work offset of the part in the machine with the rotary axes at zero, mm; required "
                "with rotary axes (with --tcp only for a rotary table, unless --approach direct)");
  options.add()(
      "approach", po::value<std::string>()->default_value("safe")->value_name("safe|direct"),
      "safe: as described above; direct: one rapid of all axes to the first location, no retract");
  options.add()("clearance", po::value<std::string>()->value_name("\"10 mm\""),
                "distance over which the tool approaches along its axis (mm); default: 10 mm");
  options.add()("retract", po::value<std::string>()->value_name("Z=400"),
                "machine coordinate of Z to retract to (mm); default: axis.Z.retract_mm of the "
                "machine file, or the upper travel limit");
  options.add()("work-system", po::value<int>()->default_value(54)->value_name("54..59"),
                "G54 to G59");
  options.add()("tools", po::value<std::string>()->value_name("TABLE"),
                "tool table in LinuxCNC's format, mm: lengths of the tools");
  options.add()(
      "tool-length", po::value<std::vector<std::string>>()->value_name("\"110 mm\""),
      "length of every tool, or 1=110 of tool 1 (mm); this or --tools is required (0 is allowed)");
  options.add()("tool", po::value<int>()->value_name("N"),
                "tool in the spindle before the first LOADTL; default: T1 if the file has no "
                "LOADTL and --tool-length is given; 0: no tool, G49, with --tool-length 0");
  options.add()("feed", po::value<std::string>()->value_name("\"300 mm/min\""),
                "feed of the TCP where the file specifies none (mm/min)");
  options.add()(
      "rotary-feed",
      po::value<std::string>()->default_value("3600 deg/min")->value_name("\"3600 deg/min\""),
      "feed of the tool axis where the TCP is at rest (deg/min)");
  options.add()(
      "start", po::value<std::string>()->value_name("A=10,C=90"),
      "axis positions near which the solution for the first location is chosen; default: zero");
  options.add()("force,f", "replaces the program if it exists");
  options.add()("json", "prints the report as one JSON object");
  options.add()("quiet,q", "prints only warnings and faults");
}

}  // namespace servomill::tools

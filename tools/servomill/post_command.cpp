#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <utility>

#include "plant/vocabulary/units.h"
#include "sim/post_file.h"
#include "sim/sweep/design.h"
#include "sim/write_file.h"
#include "tools/servomill/command.h"

namespace servomill::tools {
namespace {

// The number of an option within bounds, both included.
double number_option(const Options& options, const std::string& name, double least, double most) {
  const double value = options.get<double>(name);
  if (value >= least && value <= most) return value;
  throw InputError({"--" + name},
                   fmt::format("{:g}; must be >= {:g} and <= {:g}", value, least, most));
}

// "10,0,-5.5" in mm
Eigen::Vector3d part_zero_of(const std::string& text) {
  std::array<double, 3> values{};
  std::size_t from = 0, n = 0;
  for (; n < values.size() && from <= text.size(); ++n) {
    const std::size_t end = std::min(text.find(',', from), text.size());
    values[n] = sim::number_of(text.substr(from, end - from)) * mm;
    if (!std::isfinite(values[n])) break;
    from = end + 1;
  }
  if (n < values.size() || from <= text.size()) {
    throw InputError({"--part-zero " + text}, "must be three numbers in mm, such as 10,0,-5.5");
  }
  return {values[0], values[1], values[2]};
}

// A file may have one a line.
void tell(const std::vector<controllers::Warning>& warnings) {
  constexpr std::size_t kMostTold = 20;
  for (std::size_t i = 0; i < std::min(kMostTold, warnings.size()); ++i) {
    fmt::print(stderr, "{}\n", to_string(warnings[i]));
  }
  if (warnings.size() > kMostTold) {
    fmt::print(stderr, "and {} more warnings\n", warnings.size() - kMostTold);
  }
}

// Odd things explain faults.
sim::PostedFile post(sim::PostRequest request) {
  std::vector<controllers::Warning> warnings;
  try {
    return sim::post_file(std::move(request), &warnings);
  } catch (const InputError&) {
    tell(warnings);
    throw;
  }
}

std::string program_name(const Options& options) {
  if (options.has("output")) return options.get<std::string>("output");
  return std::filesystem::path(options.word()).stem().string() + ".ngc";
}

sim::PostRequest request_of(const Options& options) {
  constexpr double kLeast = 1e-3, kMost = 1e9;
  if (!options.has("machine")) {
    throw InputError({"servomill post"}, "needs --machine M.toml; see --help");
  }
  if (options.has("tcp") && options.has("classical")) {
    throw InputError({"servomill post"}, "--tcp and --classical exclude each other");
  }
  if (options.has("tools") && options.has("tool-length")) {
    throw InputError({"servomill post"}, "--tools and --tool-length exclude each other");
  }
  sim::PostRequest request;
  request.cl_file = options.word();
  request.machine_file = options.get<std::string>("machine");
  request.changes = options.list("set");
  if (options.has("tools")) request.tool_table = options.get<std::string>("tools");
  if (options.has("tool-length")) {
    request.tool_length = number_option(options, "tool-length", 0.0, kMost) * mm;
  }
  if (options.has("start")) request.start = options.get<std::string>("start");
  controllers::PostOptions& post = request.options;
  post.mode = options.has("tcp")         ? controllers::PostMode::tip
              : options.has("classical") ? controllers::PostMode::locations
                                         : controllers::PostMode::joints;
  post.tolerance.tip = number_option(options, "tolerance", kLeast, kMost) * um;
  post.tolerance.axis = number_option(options, "axis-tolerance", kLeast, kMost) * urad;
  if (options.has("feed")) post.feed = number_option(options, "feed", kLeast, kMost) * mm_per_min;
  post.turn_rate = number_option(options, "turn-feed", kLeast, kMost) * deg_per_min;
  if (options.has("part-zero")) {
    post.part_zero = part_zero_of(options.get<std::string>("part-zero"));
  }
  post.work_system = static_cast<int>(number_option(options, "work-system", 54, 59)) - 53;
  if (options.has("tool")) post.tool = static_cast<int>(number_option(options, "tool", 1, 99999));
  return request;
}

}  // namespace

int post_command(const Arguments& arguments) {
  namespace po = boost::program_options;
  Options options(
      "post", "PART.cls --machine M.toml [-o OUT.ngc] [...]",
      "Posts cutter locations to G-code for a machine. PART is an APT cutter location file\n"
      "(GOTO, FEDRAT, RAPID, ...) or, named .csv, a table x,y,z,i,j,k[,feed].\n\n"
      "Between locations the tip goes straight and the tool axis on a great circle: points are\n"
      "inserted where the axes alone would leave the tolerance. The feed is that of the tip; each\n"
      "block says how long it takes (G93). The first location is approached by a rapid.\n"
      "Every location takes the axis positions nearest to those before, within the travel.",
      "PART.cls");
  options.add()("machine,m", po::value<std::string>()->value_name("M.toml"), "machine file");
  options.add()("set", po::value<std::vector<std::string>>()->value_name("KEY=VALUE"),
                "changes a key of the machine, such as axis.A.centre_mm=[0,0,-150]");
  options.add()("output,o", po::value<std::string>()->value_name("OUT.ngc"),
                "program; - for standard output. Default: PART.ngc in the current folder");
  options.add()(
      "tolerance", po::value<double>()->default_value(1.0, "1")->value_name("UM"),
      "by which the tip may leave the straight way, um: half of it for the chords between "
      "inserted points, half for the NC to round corners (G64 P)");
  options.add()("axis-tolerance",
                po::value<double>()->default_value(100.0, "100")->value_name("URAD"),
                "by which the tool axis may leave its great circle, urad");
  options.add()("classical", "one block a location, nothing between them");
  options.add()("tcp", "for an NC with tool-centre-point control: G43.4, X Y Z are the tip");
  options.add()("part-zero", po::value<std::string>()->value_name("X,Y,Z"),
                "where the part's zero lies in the machine when the rotary axes are at zero, mm: "
                "what the NC's work offset holds. Default: 0,0,0");
  options.add()("work-system", po::value<double>()->default_value(54.0, "54")->value_name("54..59"),
                "G54 to G59");
  options.add()("tools", po::value<std::string>()->value_name("TABLE"),
                "tool table in LinuxCNC's format, mm: lengths of the tools");
  options.add()("tool-length", po::value<double>()->value_name("MM"), "length of every tool");
  options.add()("tool", po::value<double>()->value_name("N"),
                "tool of a file that loads none (LOADTL)");
  options.add()("feed", po::value<double>()->value_name("F"),
                "feed of the tip where the file gives none, mm/min");
  options.add()("turn-feed", po::value<double>()->default_value(3600.0, "3600")->value_name("F"),
                "of the tool axis where the tip stands still, deg/min");
  options.add()("start", po::value<std::string>()->value_name("A=10,C=90"),
                "axis positions near which the first location is sought; default: zero");
  options.add()("force,f", "replaces the program if it exists");
  options.add()("quiet,q", "prints nothing but warnings and faults");
  if (!options.parse(arguments)) return kDone;

  const std::string name = program_name(options);
  const bool to_stdout = name == "-";
  sim::PostRequest request = request_of(options);
  if (!to_stdout) sim::refuse_unwritable_text(name, options.has("force"));
  const sim::PostedFile posted = post(std::move(request));
  tell(posted.warnings);
  if (to_stdout) {
    std::fwrite(posted.program.data(), 1, posted.program.size(), stdout);
  } else {
    sim::write_text_file(name, posted.program, options.has("force"));
  }
  if (!options.has("quiet")) {
    fmt::print(to_stdout ? stderr : stdout, "{}: {} locations, {} points between them\n", name,
               posted.locations, posted.inserted);
  }
  return kDone;
}

}  // namespace servomill::tools

#include "tools/servomill/compensate_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "plant/vocabulary/units.h"
#include "sim/config/written_number.h"
#include "sim/model/machine.h"
#include "tools/servomill/axis_options.h"
#include "tools/servomill/program_options.h"

namespace servomill::tools {
namespace {

namespace fs = std::filesystem;
namespace po = boost::program_options;

sim::programs::Dialect dialect_of(const Options& options) {
  return static_cast<sim::programs::Dialect>(
      choice_option(options, "dialect", sim::programs::kDialects));
}

// As programs are called on each control; of LinuxCNC as the one that was read.
constexpr std::array<std::string_view, 4> kExtensions = {"", ".h", ".nc", ".mpf"};

// A name that every control takes: letters, digits, '_'.
std::string plain_name(const std::string& stem) {
  std::string out;
  for (const char c : stem) {
    const bool is_plain =
        (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_';
    out += is_plain ? c : '_';
  }
  return out.empty() ? "program" : out;
}

std::string upper(std::string text) {
  for (char& c : text) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return text;
}

// Fanuc's program number: as given, or the digits of a file called 1234.ngc or O1234.ngc; 0: none.
int program_number(const Options& options) {
  constexpr int kMax = 9999;
  const bool is_given = options.has("program-number");
  std::string text = is_given ? options.get<std::string>("program-number")
                              : fs::path(options.word()).stem().string();
  if (!is_given && !text.empty() && (text[0] == 'O' || text[0] == 'o')) text.erase(0, 1);
  const bool is_number = !text.empty() && text.size() <= 4 &&
                         text.find_first_not_of("0123456789") == std::string::npos;
  const int number = is_number ? std::stoi(text) : 0;
  if (number >= 1 && number <= kMax) return number;
  if (!is_given) return 0;
  throw InputError({"--program-number " + text}, "must be 1 ... 9999");
}

}  // namespace

std::string compensated_name(const Options& options) {
  if (options.has("output")) return options.get<std::string>("output");
  const fs::path path(options.word());
  const sim::programs::Dialect dialect = dialect_of(options);
  const std::string extension(kExtensions[static_cast<std::size_t>(dialect)]);
  std::string name = path.stem().string() + ".compensated" + path.extension().string();
  if (dialect == sim::programs::Dialect::fanuc && program_number(options) > 0) {
    name = fmt::format("O{:04}{}", program_number(options), extension);
  } else if (dialect != sim::programs::Dialect::linuxcnc) {
    name = plain_name(path.stem().string()) + "_compensated" + extension;
  }
  return (path.parent_path() / name).string();
}

namespace {

// Name of the program, from its file.
std::string program_name(const Options& options) {
  const std::string output = compensated_name(options);
  const bool is_file = output != "-";
  const std::string stem = fs::path(is_file ? output : options.word()).stem().string();
  const std::string name = plain_name(stem);
  if (is_file && name != stem && dialect_of(options) == sim::programs::Dialect::heidenhain) {
    throw InputError({"--output " + output},
                     "must consist of letters, digits and '_', because the program takes its name "
                     "from the file");
  }
  return upper(name);
}

// A power of ten in mm, so that positions have whole digits.
double resolution_of(const Options& options) {
  const double resolution =
      positive_option(options, "resolution", sim::config::kLength, "um").value_or(0.0);
  if (resolution == 0.0) return 0.0;
  const double digits = -std::log10(resolution / mm);
  if (std::abs(digits - std::round(digits)) < 1e-6 && digits > 1.5 && digits < 6.5) {
    return resolution;
  }
  throw InputError({"--resolution"}, "must be 0.01 mm, 1 um, 0.1 um, ... or 1 nm");
}

std::optional<int> preset_of(const Options& options) {
  if (!options.has("preset")) return std::nullopt;
  const auto& text = options.get<std::string>("preset");
  const double number = sim::config::number_of(text);
  if (number >= 0.0 && number <= 9999.0 && number == std::floor(number)) {
    return static_cast<int>(number);
  }
  throw InputError({"--preset " + text}, "must be a row of the preset table, 0 ... 9999");
}

// "polar,mirror"
std::vector<std::string> absent_functions(const Options& options) {
  std::vector<std::string> out;
  if (!options.has("without")) return out;
  std::vector<std::string_view> names;
  for (const sim::programs::FanucFunction& one : sim::programs::kFanucFunctions)
    names.push_back(one.name);
  std::string_view rest = options.get<std::string>("without");
  while (true) {
    const std::size_t end = std::min(rest.find(','), rest.size());
    const std::string_view name = rest.substr(0, end);
    if (std::find(names.begin(), names.end(), name) == names.end()) {
      throw InputError({"--without"},
                       fmt::format("'{}' is not allowed; must be one of {}{}", name,
                                   fmt::join(names, ", "), did_you_mean(name, names)));
    }
    out.emplace_back(name);
    if (end == rest.size()) return out;
    rest.remove_prefix(end + 1);
  }
}

std::string text_of(const Options& options, const std::string& name) {
  return options.has(name) ? options.get<std::string>(name) : std::string();
}

void add_correction_options(Options& options) {
  const auto text = [] { return po::value<std::string>(); };
  const auto texts = [] { return po::value<std::vector<std::string>>(); };
  options.add()("machine,m", text()->value_name("M.toml"), "machine file, with its [errors.NAME]");
  options.add()("errors", text()->value_name("E.toml"),
                "file of error models [errors.NAME], instead of the machine's own");
  options.add()("model", text()->value_name("NAME"), "error model; required if there are several");
  options.add()(
      "servo", text()->value_name("MODEL.toml"),
      "machine file of an identified model, such as servomill identify writes: also corrects the "
      "effects of servo loops, friction and structure that this model predicts");
  options.add()("cutoff", text()->value_name("\"40 Hz\""),
                "with --servo: cut-off frequency of the low-pass of the offset; default: 40 Hz");
  options.add()("set", texts()->value_name("KEY=VALUE"),
                "changes a key of the machine, such as errors.measured.EC0Y.um_per_m=120");
  options.add()("output,o", text()->value_name("OUT"),
                "corrected program; - for standard output. Default: PROGRAM with .compensated "
                "before its extension; PROGRAM_compensated.h or .mpf for heidenhain, siemens, "
                "O1234.nc for fanuc");
  options.add()("tolerance", text()->default_value("1 um")->value_name("\"1 um\""),
                "largest deviation from the exactly corrected path; a bare number is in um");
  options.add()(
      "max-block", text()->value_name("\"1 mm\""),
      "longest block where the correction varies, bare numbers in mm; default: as long as "
      "the tolerance allows");
  options.add()("correct-rapids", "corrects G0 along its path, too");
  options.add()("axes", text()->default_value("linear")->value_name("linear|all"),
                "axes that carry the correction: X, Y and Z only, or all including rotary axes");
  options.add()(
      "leave", text()->value_name("Z"),
      "linear axes that stay as programmed, such as Z or XZ: for errors that the readings "
      "of a calibrated machine do not determine");
}

void add_control_options(Options& options) {
  const auto text = [] { return po::value<std::string>(); };
  options.add()("dialect", text()->default_value("linuxcnc")->value_name("NAME"),
                "linuxcnc, or blocks for heidenhain, fanuc, siemens");
  options.add()("retract", text()->value_name("Z=-5"),
                "other dialects: machine coordinate to which Z retracts before and after, mm; "
                "default: axis.Z.retract_mm of the machine file");
  options.add()("program-number", text()->value_name("1234"),
                "fanuc: number of the program; default: that of a file called 1234 or O1234");
  options.add()(
      "resolution", text()->value_name("\"1 um\""),
      "other dialects: resolution of positions, bare numbers in um; default: 1 um (IS-B), "
      "siemens 10 nm");
  options.add()("smoothing", text()->value_name("\"10 um\""),
                "other dialects: switches on the smoothing of the control for feeds (G5.1 Q1, "
                "CYCLE832, cycle 32) with this tolerance; short blocks run faster, and the path "
                "may deviate from the corrected one by the tolerance");
  options.add()("preset", text()->value_name("N"),
                "heidenhain: activates this row of the preset table (cycle 247) as G54; default: "
                "the active preset is G54");
  options.add()("without", text()->value_name("polar,mirror"),
                "fanuc: options that the control does not have; the codes that cancel them are "
                "omitted, because they would cause an alarm: polar (G15), scaling (G50), mirror "
                "(G50.1), surface-speed (G97), preset (G92.1); and settings that it does not have: "
                "rollover of rotary axes (No. 1008#0), length-b (No. 5001#1: without it arcs in "
                "G18 and G19 stay arcs). Default: the control may have all of them");
}

void add_other_options(Options& options) {
  const auto text = [] { return po::value<std::string>(); };
  const auto texts = [] { return po::value<std::vector<std::string>>(); };
  add_program_options(options);
  options.add()(
      "work-offset", texts()->value_name("X=10,Y=-5"),
      "position of G54 in the machine, such as X=10,Y=-5 (mm, deg) or \"X=10 mm\"; G55:X=10,R=30 "
      "for another work offset with a rotation; may be given once per axis");
  options.add()("tool-length", texts()->value_name("1=50"),
                "length of tool 1 (in mm, or \"1=50 mm\"), overrides --tools");
  options.add()("start", text()->value_name("X=0,Y=0"),
                "machine position before the program, for programs that feed before every axis has "
                "been programmed");
  options.add()("record", text()->value_name("OUT.h5"),
                "writes path and correction, for tools/plot.py");
  options.add()(
      "point-uncertainty", text()->value_name("OUT.csv"),
      "writes the expanded uncertainty (k = 2) of every corrected point, from the covariance in "
      "the machine file of servomill calibrate; the report gives maximum and rms");
  options.add()("json", "prints the changes as JSON");
  options.add()("force,f", "replaces OUT if it exists");
  options.add()("quiet,q", "prints only warnings and faults");
}

std::array<bool, kLinearJoints> left_axes(const Options& options) {
  std::array<bool, kLinearJoints> out{};
  for (const char c : text_of(options, "leave")) {
    const auto axis = axis_of(c);
    if (!axis || !is_linear(*axis)) {
      throw InputError({"--leave"}, fmt::format("'{}'; must be letters of X, Y and Z, such as XZ",
                                                options.get<std::string>("leave")));
    }
    out[static_cast<std::size_t>(index_of(*axis))] = true;
  }
  return out;
}

}  // namespace

sim::programs::CompensateRequest compensate_request(const Options& options) {
  constexpr std::array<std::string_view, 2> kAxes = {"linear", "all"};
  if (!options.has("machine")) {
    throw InputError({"servomill compensate"}, "needs --machine M.toml; see --help");
  }
  sim::programs::CompensateRequest request;
  request.program_file = options.word();
  request.machine_file = options.get<std::string>("machine");
  request.error_file = text_of(options, "errors");
  request.model = text_of(options, "model");
  request.changes = options.list("set");
  request.servo_file = text_of(options, "servo");
  if (options.has("cutoff") && request.servo_file.empty()) {
    throw InputError({"--cutoff"}, "applies to --servo, which is not given");
  }
  request.cutoff =
      positive_option(options, "cutoff", sim::config::kRate, "Hz").value_or(request.cutoff);
  request.tolerance = *positive_option(options, "tolerance", sim::config::kLength, "um");
  constexpr double kMin = 1e-9;  // m; control and machine know nothing of less
  if (request.tolerance < kMin * (1.0 - 1e-9)) {
    throw InputError({"--tolerance"}, fmt::format("'{}' must be >= 0.001 um",
                                                  options.get<std::string>("tolerance")));
  }
  request.max_block =
      positive_option(options, "max-block", sim::config::kLength, "mm").value_or(0.0);
  request.corrects_rapids = options.has("correct-rapids");
  request.axes = static_cast<strategies::DisplacedAxes>(choice_option(options, "axes", kAxes));
  request.left = left_axes(options);
  request.dialect = dialect_of(options);
  request.inputs = program_inputs(options);
  request.inputs.machine.clear();  // tool-centre-point control is not corrected
  request.work_offsets = options.list("work-offset");
  request.tool_lengths = options.list("tool-length");
  request.start = text_of(options, "start");
  request.program_name = program_name(options);
  request.program_number = program_number(options);
  request.resolution = resolution_of(options);
  request.retract_Z = retract_option(options);
  request.smoothing =
      positive_option(options, "smoothing", sim::config::kLength, "um").value_or(0.0);
  request.preset = preset_of(options);
  request.without = absent_functions(options);
  request.records = options.has("record");
  request.lists_uncertainty = options.has("point-uncertainty");
  return request;
}

void add_compensate_options(Options& options) {
  add_correction_options(options);
  add_control_options(options);
  add_other_options(options);
}

}  // namespace servomill::tools

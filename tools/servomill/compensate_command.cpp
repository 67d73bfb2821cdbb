#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "plant/vocabulary/units.h"
#include "sim/compensate/compensate.h"
#include "sim/output_name.h"
#include "sim/store.h"
#include "sim/write_file.h"
#include "tools/servomill/axis_options.h"
#include "tools/servomill/program_options.h"

namespace servomill::tools {
namespace {

namespace fs = std::filesystem;

sim::Dialect dialect_of(const Options& options) {
  return static_cast<sim::Dialect>(choice_option(options, "dialect", sim::kDialects));
}

// As programs are called on each control; of LinuxCNC as the one that was read.
constexpr std::array<std::string_view, 4> kExtensions = {"", ".h", ".nc", ".mpf"};

std::string program_name(const Options& options) {
  if (options.has("output")) return options.get<std::string>("output");
  const fs::path path(options.word());
  std::string extension(kExtensions[static_cast<std::size_t>(dialect_of(options))]);
  if (extension.empty()) extension = path.extension().string();
  return (path.parent_path() / (path.stem().string() + ".compensated" + extension)).string();
}

std::string text_of(const Options& options, const std::string& name) {
  return options.has(name) ? options.get<std::string>(name) : std::string();
}

sim::CompensateRequest request_of(const Options& options) {
  constexpr std::array<std::string_view, 2> kAxes = {"linear", "all"};
  if (!options.has("machine")) {
    throw InputError({"servomill compensate"}, "needs --machine M.toml; see --help");
  }
  sim::CompensateRequest request;
  request.program_file = options.word();
  request.machine_file = options.get<std::string>("machine");
  request.error_file = text_of(options, "errors");
  request.model = text_of(options, "model");
  request.changes = options.list("set");
  request.tolerance = *positive_option(options, "tolerance", sim::kLength);
  request.max_block = positive_option(options, "max-block", sim::kLength).value_or(0.0);
  request.splits_rapids = options.has("split-rapids");
  request.axes = static_cast<strategies::DisplacedAxes>(choice_option(options, "axes", kAxes));
  request.dialect = dialect_of(options);
  request.inputs = program_inputs(options);
  request.inputs.machine.clear();  // tool-centre-point control is not corrected
  request.work_offsets = options.list("work-offset");
  request.start = text_of(options, "start");
  request.records = options.has("record");
  return request;
}

// Before the work: what cannot be written afterwards.
void refuse_outputs(const Options& options, const std::string& name) {
  const bool force = options.has("force"), to_stdout = name == "-";
  if (!to_stdout) sim::refuse_unwritable_text(name, force);
  if (!options.has("record")) return;
  const auto& record = options.get<std::string>("record");
  sim::writable_name(record, force);
  if (!to_stdout) sim::refuse_same_output(record, name, "--record", "the program");
}

}  // namespace

int compensate_command(const Arguments& arguments) {
  namespace po = boost::program_options;
  Options options(
      "compensate", "PROGRAM --machine M.toml [-o OUT] [...]",
      "Writes a program corrected for the errors of the machine that runs it. What is not motion\n"
      "stays as it stands: comments, spindle, coolant, tools, order. Moves are split only as far "
      "as\n"
      "the tolerance asks for; arcs stay arcs where they can. Loops and subroutines are unrolled,\n"
      "expressions become numbers, canned cycles and cutter compensation their moves.\n\n"
      "Errors depend on machine coordinates: say where the work lies (--work-offset or\n"
      "--parameter-file) and how long the tools are (--tools). Places of the machine (G53, G28, "
      "G30)\n"
      "are not corrected, rapids at their ends only.",
      "PROGRAM");
  const auto text = [] { return po::value<std::string>(); };
  const auto texts = [] { return po::value<std::vector<std::string>>(); };
  options.add()("machine,m", text()->value_name("M.toml"), "machine file, with its [errors.NAME]");
  options.add()("errors", text()->value_name("E.toml"),
                "file of error models [errors.NAME], instead of the machine's own");
  options.add()("model", text()->value_name("NAME"), "error model; needed if there are several");
  options.add()("set", texts()->value_name("KEY=VALUE"),
                "changes a key of the machine, such as errors.measured.EC0Y.um_per_m=120");
  options.add()("output,o", text()->value_name("OUT"),
                "corrected program; - for standard output. Default: PROGRAM with .compensated "
                "before its extension, which is .h, .nc or .mpf for heidenhain, fanuc, siemens");
  options.add()("tolerance", text()->default_value("1 um")->value_name("\"1 um\""),
                "by which the path may leave the exactly corrected one");
  options.add()("max-block", text()->value_name("\"1 mm\""),
                "longest block where the correction varies; default: as long as the tolerance "
                "allows");
  options.add()("split-rapids", "corrects G0 on its way, too");
  options.add()("axes", text()->default_value("linear")->value_name("linear|all"),
                "axes that correct: X, Y, Z, or rotary axes, too");
  options.add()("dialect", text()->default_value("linuxcnc")->value_name("NAME"),
                "linuxcnc, or lines for heidenhain, fanuc, siemens");
  add_program_options(options);
  options.add()("work-offset", texts()->value_name("X=10,Y=-5"),
                "where G54 lies in the machine, mm and deg; G55:X=10,R=30 for another one and with "
                "a rotation");
  options.add()("start", text()->value_name("X=0,Y=0"),
                "where the machine stands before the program, in machine coordinates: for programs "
                "that feed before every axis was named");
  options.add()("record", text()->value_name("OUT.h5"), "path and correction, for tools/plot.py");
  options.add()("json", "prints what it changed as JSON");
  options.add()("force,f", "replaces OUT if it exists");
  options.add()("quiet,q", "prints nothing but warnings and faults");
  if (!options.parse(arguments)) return kDone;

  const std::string name = program_name(options);
  const bool to_stdout = name == "-", force = options.has("force");
  const sim::CompensateRequest request = request_of(options);
  refuse_outputs(options, name);
  const sim::Compensated done = sim::compensate(request);
  if (!to_stdout) sim::write_text_file(name, done.program, force);
  if (options.has("record")) {
    done.record.write(options.get<std::string>("record"), force,
                      fs::path(options.word()).filename().string(), done.machine);
  }
  for (const Fault& warning : done.warnings) {
    fmt::print(stderr, "{}: warning: {}\n", to_string(warning.place), warning.message);
  }
  if (to_stdout) std::fwrite(done.program.data(), 1, done.program.size(), stdout);
  if (options.has("quiet")) return kDone;
  std::FILE* to = to_stdout ? stderr : stdout;
  if (options.has("json")) {
    fmt::print(to, "{}\n", done.json);
    return kDone;
  }
  if (!to_stdout) fmt::print(to, "{}:\n", name);
  for (const std::string& line : done.report) fmt::print(to, "  {}\n", line);
  return kDone;
}

}  // namespace servomill::tools

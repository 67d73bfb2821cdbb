#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <string>

#include "plant/vocabulary/input_error.h"
#include "sim/programs/compensate/compensate.h"
#include "sim/run/result_file.h"
#include "sim/system/output_name.h"
#include "sim/system/write_file.h"
#include "tools/servomill/command.h"
#include "tools/servomill/compensate_options.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {
namespace {

namespace fs = std::filesystem;

// Before the work: what cannot be written afterwards.
void refuse_outputs(const Options& options, const std::string& name) {
  const bool force = options.has("force"), to_stdout = name == "-";
  if (!to_stdout) sim::system::refuse_unwritable_text(name, force);
  refuse_unwritable(options, output_of(options, "point-uncertainty", ".csv"));
  if (!options.has("record")) return;
  const auto& record = options.get<std::string>("record");
  sim::run::writable_name(record, force);
  if (!to_stdout) sim::system::refuse_same_output(record, name, "--record", "the program");
}

}  // namespace

int compensate_command(const Arguments& arguments) {
  Options options(
      "compensate", "PROGRAM --machine M.toml [-o OUT] [...]",
      "Writes a program with the errors of the machine corrected. Only motion changes: comments,\n"
      "spindle, coolant, tool calls and the order of blocks are kept. Moves are split only as far\n"
      "as the tolerance requires, and arcs remain arcs where possible. Loops and subroutines are\n"
      "unrolled, expressions are replaced by numbers, canned cycles and cutter compensation by\n"
      "their moves.\n"
      "\n"
      "Errors depend on machine coordinates: give the work offset (--work-offset or\n"
      "--parameter-file) and the tool lengths (--tools or --tool-length). Machine positions (G53,\n"
      "G28, G30) are not corrected, rapids are corrected at their end points only.\n"
      "\n"
      "The result is read back as its control reads it, under every setting of the machine\n"
      "builder, and compared with the original before the file gets its name. A result that\n"
      "differs is refused.",
      "PROGRAM");
  add_compensate_options(options);
  if (!options.parse(arguments)) return kDone;

  const std::string name = compensated_name(options);
  const bool to_stdout = name == "-", force = options.has("force");
  ProgressLine line(options);
  const sim::programs::CompensateRequest request = compensate_request(options);
  refuse_outputs(options, name);
  const sim::programs::Compensated done = sim::programs::compensate(request);
  line.end();
  if (!to_stdout) sim::system::write_text_file(name, done.program, force);
  if (const std::string points = output_of(options, "point-uncertainty", ".csv"); !points.empty()) {
    sim::system::write_text_file(points, sim::programs::points_csv(done), force);
  }
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
  for (const std::string& text : done.report) fmt::print(to, "  {}\n", text);
  return kDone;
}

}  // namespace servomill::tools

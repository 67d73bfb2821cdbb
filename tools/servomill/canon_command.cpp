#include <fmt/format.h>

#include <cstdio>

#include "plant/vocabulary/input_error.h"
#include "sim/programs/canonical_moves.h"
#include "tools/servomill/command.h"
#include "tools/servomill/program_options.h"
#include "tools/servomill/progress_line.h"

namespace servomill::tools {

int canon_command(const Arguments& arguments) {
  namespace po = boost::program_options;
  Options options("canon",
                  "PROGRAM [--tools TABLE] [--parameter '#101=1394']... [--machine M.toml]...",
                  "Prints the canonical moves of a program, one JSON object per line: lengths in "
                  "mm, angles in deg, end points in work and machine coordinates. Under G43.4, "
                  "G43.5 and G68.2 (\"control\") the latter are the TCP in the workpiece.",
                  "PROGRAM");
  add_program_options(options);
  add_machine_option(options);
  add_plugin_option(options);
  if (!options.parse(arguments)) return kDone;
  load_plugins(options);
  ProgressLine line(options);
  const auto warnings =
      sim::programs::canon(options.word(), program_inputs(options), [&](std::string_view lines) {
        const auto hidden = line.hidden();
        std::fwrite(lines.data(), 1, lines.size(), stdout);
      });
  line.end();
  for (const Fault& warning : warnings) {
    fmt::print(stderr, "{}: warning: {}\n", to_string(warning.place), warning.message);
  }
  return kDone;
}

}  // namespace servomill::tools

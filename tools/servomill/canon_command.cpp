#include <fmt/format.h>

#include <cstdio>

#include "plant/vocabulary/input_error.h"
#include "sim/canon.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

int canon_command(const Arguments& arguments) {
  namespace po = boost::program_options;
  Options options("canon",
                  "PROGRAM [--tools TABLE] [--parameter '#101=1394']... [--machine M.toml]",
                  "Prints the canonical moves of a program, one JSON object a line: lengths in mm, "
                  "angles in deg, end points in work and machine coordinates. Under G43.4, G43.5 "
                  "and G68.2 (\"control\") the latter are the tip in the workpiece.",
                  "PROGRAM");
  options.add()("tools", po::value<std::string>()->value_name("TABLE"),
                "tool table in LinuxCNC's format, mm");
  options.add()("parameter", po::value<std::vector<std::string>>()->value_name("#N=NUMBER"),
                "sets a parameter before the program runs, such as '#101=1394'");
  options.add()("machine", po::value<std::string>()->value_name("M.toml"),
                "machine that runs it: G43.5, G53.1, and G43.4 or G68.2 with turned axes need it");
  if (!options.parse(arguments)) return kDone;
  const sim::ProgramInputs inputs = {
      options.has("tools") ? options.get<std::string>("tools") : "", options.list("parameter"),
      options.has("machine") ? options.get<std::string>("machine") : ""};
  const auto warnings = sim::canon(options.word(), inputs, [](const std::string& line) {
    std::fputs(line.c_str(), stdout);
    std::fputc('\n', stdout);
  });
  for (const Fault& warning : warnings) {
    fmt::print(stderr, "{}: warning: {}\n", to_string(warning.place), warning.message);
  }
  return kDone;
}

}  // namespace servomill::tools

#include <cstdio>

#include "sim/canon.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

int canon_command(const Arguments& arguments) {
  namespace po = boost::program_options;
  Options options("canon", "PROGRAM [--tools TABLE]",
                  "Prints the canonical moves of a program, one JSON object a line: lengths in mm, "
                  "angles in deg, end points in work and machine coordinates.",
                  "PROGRAM");
  options.add()("tools", po::value<std::string>()->value_name("TABLE"),
                "tool table in LinuxCNC's format, mm");
  if (!options.parse(arguments)) return kDone;
  const std::string tools = options.has("tools") ? options.get<std::string>("tools") : "";
  sim::canon(options.word(), tools, [](const std::string& line) {
    std::fputs(line.c_str(), stdout);
    std::fputc('\n', stdout);
  });
  return kDone;
}

}  // namespace servomill::tools

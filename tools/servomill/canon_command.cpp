#include <cstdio>

#include "sim/canon.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

int canon_command(const Arguments& arguments) {
  namespace po = boost::program_options;
  Options options("canon", "PROGRAM [--tools TABLE] [--parameter '#101=1394']...",
                  "Prints the canonical moves of a program, one JSON object a line: lengths in mm, "
                  "angles in deg, end points in work and machine coordinates.",
                  "PROGRAM");
  options.add()("tools", po::value<std::string>()->value_name("TABLE"),
                "tool table in LinuxCNC's format, mm");
  options.add()("parameter", po::value<std::vector<std::string>>()->value_name("#N=NUMBER"),
                "sets a parameter before the program runs, such as '#101=1394'");
  if (!options.parse(arguments)) return kDone;
  const sim::ProgramInputs inputs = {options.has("tools") ? options.get<std::string>("tools") : "",
                                     options.list("parameter")};
  sim::canon(options.word(), inputs, [](const std::string& line) {
    std::fputs(line.c_str(), stdout);
    std::fputc('\n', stdout);
  });
  return kDone;
}

}  // namespace servomill::tools

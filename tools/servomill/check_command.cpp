#include <fmt/format.h>

#include "plant/vocabulary/input_error.h"
#include "sim/programs/canon.h"
#include "tools/servomill/command.h"
#include "tools/servomill/program_options.h"

namespace servomill::tools {

int check_command(const Arguments& arguments) {
  namespace po = boost::program_options;
  Options options(
      "check", "FILE... [--set KEY=VALUE]... [--tools TABLE]",
      "Checks scenarios and machines (.toml), cutter locations (.cls, .apt, .csv) and programs "
      "(all others) and prints every fault with file:line:column. Scenarios are prepared as for a "
      "run, up to the first "
      "tick, at every point of their sweep.",
      "FILE");
  options.add()("set", po::value<std::vector<std::string>>()->value_name("KEY=VALUE"),
                "changes a key of the scenarios, as for servomill run");
  add_program_options(options);
  add_machine_option(options);
  options.add()("quiet,q", "prints nothing but faults");
  if (!options.parse(arguments)) return kDone;
  if (options.words().empty()) throw InputError({"servomill check"}, "needs a FILE; see --help");
  const sim::ProgramInputs inputs = program_inputs(options);
  std::size_t faults = 0;
  for (const std::string& path : options.words()) {
    std::vector<Fault> warnings;
    const auto found = sim::check_file(path, options.list("set"), inputs, &warnings);
    for (const Fault& warning : warnings) {
      fmt::print(stderr, "{}: warning: {}\n", to_string(warning.place), warning.message);
    }
    for (const Fault& fault : found) fmt::print(stderr, "{}\n", to_string(fault));
    if (found.empty() && !options.has("quiet")) fmt::print("{}: no faults\n", path);
    faults += found.size();
  }
  return faults == 0 ? kDone : kInputWrong;
}

}  // namespace servomill::tools

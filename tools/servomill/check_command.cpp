#include <fmt/format.h>

#include "plant/vocabulary/input_error.h"
#include "sim/canon.h"
#include "tools/servomill/command.h"

namespace servomill::tools {

int check_command(const Arguments& arguments) {
  Options options(
      "check", "FILE...",
      "Checks scenarios and machines (.toml) and programs (all others) and prints every "
      "fault with file:line:column. Scenarios are prepared as for a run, up to the first "
      "tick.",
      "FILE");
  options.add()("quiet,q", "prints nothing but faults");
  if (!options.parse(arguments)) return kDone;
  if (options.words().empty()) throw InputError({"servomill check"}, "needs a FILE; see --help");
  std::size_t faults = 0;
  for (const std::string& path : options.words()) {
    const auto found = sim::check_file(path);
    for (const Fault& fault : found) fmt::print(stderr, "{}\n", to_string(fault));
    if (found.empty() && !options.has("quiet")) fmt::print("{}: no faults\n", path);
    faults += found.size();
  }
  return faults == 0 ? kDone : kInputWrong;
}

}  // namespace servomill::tools

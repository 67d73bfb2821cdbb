#include "tools/servomill/readings_options.h"

#include <limits>

#include "plant/vocabulary/input_error.h"
#include "sim/readings/readings.h"

namespace servomill::tools {

std::string measured_machine(const Options& options, const std::string& readings) {
  const bool is_given = options.has("machine");
  return measured_machine(is_given ? options.get<std::string>("machine") : "", readings);
}

std::string measured_machine(const std::string& machine, const std::string& readings) {
  if (!machine.empty()) return machine;
  if (readings.empty()) {
    throw InputError({"--machine"}, "is missing: the machine to be measured");
  }
  std::string named = sim::readings::named_machine(readings);
  if (!named.empty()) return named;
  throw InputError({readings}, "has no machine; add machine = \"FILE\", or pass --machine");
}

std::pair<Joints, Joints> travel_of(const sim::model::MachineSettings& machine) {
  Joints lower = machine.nc.lower, upper = machine.nc.upper;
  for (int j = 0; j < kJoints; ++j) {
    if (lower[j] < upper[j]) continue;
    lower[j] = -std::numeric_limits<double>::infinity();
    upper[j] = std::numeric_limits<double>::infinity();
  }
  return {lower, upper};
}

}  // namespace servomill::tools

#include "tools/servomill/readings_options.h"

#include "plant/vocabulary/input_error.h"
#include "sim/input/machine_description.h"
#include "sim/model/machine.h"
#include "sim/model/machine_parts.h"
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

MeasuredMachine read_measured_machine(const Options& options, const std::string& readings) {
  const auto described = sim::input::read_machine_description(measured_machine(options, readings));
  const auto [lower, upper] = sim::model::travel_of(*described.machine);
  return {sim::model::chain_of(*described.machine), lower, upper};
}

}  // namespace servomill::tools

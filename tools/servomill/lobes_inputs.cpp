#include "tools/servomill/lobes_inputs.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>

#include "plant/vocabulary/input_error.h"
#include "sim/input/machine_description.h"
#include "sim/input/machine_document.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"
#include "tools/servomill/axis_options.h"

namespace servomill::tools {
namespace {

plant::Cutter tool_of(const Options& options, const sim::model::ProgramSpec& program) {
  if (!options.has("tool")) {
    if (program.cutters.size() == 1) return program.cutters.begin()->second;
    if (program.cutters.empty()) return {.teeth = 0};
  }
  std::vector<std::string> numbers;
  for (const auto& [number, cutter] : program.cutters) numbers.push_back(std::to_string(number));
  const std::string there_are =
      fmt::format("the scenario has {} with a diameter_mm", fmt::join(numbers, ", "));
  if (!options.has("tool")) throw InputError({"--tool"}, "is missing; " + there_are);
  const int tool = options.get<int>("tool");
  const auto found = program.cutters.find(tool);
  if (found == program.cutters.end()) {
    throw InputError({"--tool"}, fmt::format("no tool {}; {}", tool, there_are));
  }
  return found->second;
}

}  // namespace

LobesInputs lobes_inputs(const Options& options) {
  LobesInputs out;
  if (options.words().empty()) return out;
  const std::string path = options.word();
  if (sim::input::is_machine_file(path)) {
    if (options.has("tool")) throw InputError({"--tool"}, "needs a scenario, which has tools");
    out.modes =
        sim::input::read_machine_description(path, options.list("set")).machine->structural_modes;
    return out;
  }
  const auto read = scenario_for_axes(options);
  const sim::model::Scenario& scenario = *read;
  out.modes = scenario.machine.structural_modes;
  if (scenario.cutting) out.coefficients = scenario.cutting->coefficients;
  out.cutter = tool_of(options, scenario.program);
  return out;
}

}  // namespace servomill::tools

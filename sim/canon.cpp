#include "sim/canon.h"

#include <cmath>

#include "controllers/gcode/canon_json.h"
#include "controllers/gcode/cl_data.h"
#include "controllers/gcode/interpreter.h"
#include "sim/config/document.h"
#include "sim/read_file.h"
#include "sim/run.h"
#include "sim/scenario.h"
#include "sim/sweep/sweep.h"

namespace servomill::sim {
namespace {

void check_toml(const std::string& path, const std::vector<std::string>& changes) {
  const Document document = Document::from_file(path);
  if (document.root().find("structure") != nullptr) {
    check_machine(read_machine_file(path));
    return;
  }
  const Scenario scenario = read_scenario(path, changes);
  check_scenario(scenario);
  if (!scenario.sweep.empty()) Sweep(path, changes).check();
}

bool holds_cutter_locations(std::string_view path) {
  return path.ends_with(".cls") || path.ends_with(".apt") || path.ends_with(".csv");
}

controllers::ProgramSetup setup_of(const ProgramInputs& inputs) {
  controllers::ProgramSetup setup;
  if (!inputs.tool_table.empty()) {
    setup.tools = controllers::ToolTable::parse(read_file(inputs.tool_table, {}, "tool table"),
                                                inputs.tool_table);
  }
  if (!inputs.machine.empty()) {
    setup.machine = tool_centre_point(read_machine_file(inputs.machine));
  }
  for (const std::string& parameter : inputs.parameters) {
    const std::size_t equals = parameter.find('=');
    const double value =
        equals == std::string::npos ? std::nan("") : number_of(parameter.substr(equals + 1));
    if (!std::isfinite(value)) {
      throw InputError({"--parameter " + parameter}, "must be #N=NUMBER, such as '#101=1394'");
    }
    setup.parameters[parameter.substr(0, equals)] = value;
  }
  return setup;
}

}  // namespace

std::vector<Fault> canon(const std::string& program_file, const ProgramInputs& inputs,
                         const std::function<void(const std::string&)>& line) {
  controllers::Interpreter interpreter(read_file(program_file, {}, "program"), program_file,
                                       setup_of(inputs));
  while (const auto move = interpreter.next()) line(controllers::canon_json(*move));
  return interpreter.warnings();
}

std::vector<Fault> check_file(const std::string& path, const std::vector<std::string>& changes,
                              const ProgramInputs& inputs) {
  try {
    if (path.ends_with(".toml")) {
      check_toml(path, changes);
      return {};
    }
    if (holds_cutter_locations(path)) {
      controllers::read_cl_data(read_file(path, {}, "cutter location file"), path);
      return {};
    }
    return controllers::check_program(read_file(path, {}, "program"), path, setup_of(inputs));
  } catch (const InputError& error) {
    return error.faults();
  }
}

}  // namespace servomill::sim

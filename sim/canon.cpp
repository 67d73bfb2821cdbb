#include "sim/canon.h"

#include "controllers/gcode/canon_json.h"
#include "controllers/gcode/interpreter.h"
#include "sim/config/document.h"
#include "sim/read_file.h"
#include "sim/run.h"
#include "sim/scenario.h"
#include "sim/sweep.h"

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
  if (!scenario.sweep.empty()) check_sweep(path, changes);
}

controllers::ToolTable read_tools(const std::string& file) {
  if (file.empty()) return {};
  return controllers::ToolTable::parse(read_file(file, {}, "tool table"), file);
}

}  // namespace

void canon(const std::string& program_file, const std::string& tool_table,
           const std::function<void(const std::string&)>& line) {
  controllers::ProgramSetup setup;
  setup.tools = read_tools(tool_table);
  controllers::Interpreter interpreter(read_file(program_file, {}, "program"), program_file,
                                       std::move(setup));
  while (const auto move = interpreter.next()) line(controllers::canon_json(*move));
}

std::vector<Fault> check_file(const std::string& path, const std::vector<std::string>& changes,
                              const std::string& tool_table) {
  try {
    if (path.ends_with(".toml")) {
      check_toml(path, changes);
      return {};
    }
    controllers::ProgramSetup setup;
    setup.tools = read_tools(tool_table);
    return controllers::check_program(read_file(path, {}, "program"), path, std::move(setup));
  } catch (const InputError& error) {
    return error.faults();
  }
}

}  // namespace servomill::sim

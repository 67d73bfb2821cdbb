#include "sim/canon.h"

#include "controllers/gcode/canon_json.h"
#include "controllers/gcode/interpreter.h"
#include "sim/config/document.h"
#include "sim/read_file.h"
#include "sim/run.h"
#include "sim/scenario.h"

namespace servomill::sim {
namespace {

void check_toml(const std::string& path) {
  const Document document = Document::from_file(path);
  if (document.root().find("structure") != nullptr) {
    read_machine_file(path);
    return;
  }
  const Scenario scenario = read_scenario(path);
  check_scenario(scenario);
}

}  // namespace

void canon(const std::string& program_file, const std::string& tool_table,
           const std::function<void(const std::string&)>& line) {
  controllers::ProgramSetup setup;
  if (!tool_table.empty()) {
    setup.tools =
        controllers::ToolTable::parse(read_file(tool_table, {}, "tool table"), tool_table);
  }
  controllers::Interpreter interpreter(read_file(program_file, {}, "program"), program_file,
                                       std::move(setup));
  while (const auto move = interpreter.next()) line(controllers::canon_json(*move));
}

std::vector<Fault> check_file(const std::string& path) {
  try {
    if (path.ends_with(".toml")) {
      check_toml(path);
      return {};
    }
    return controllers::check_program(read_file(path, {}, "program"), path, {});
  } catch (const InputError& error) {
    return error.faults();
  }
}

}  // namespace servomill::sim

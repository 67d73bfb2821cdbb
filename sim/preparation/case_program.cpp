#include "sim/preparation/case_program.h"

#include <optional>
#include <string>
#include <utility>

#include "controllers/gcode/interpreter.h"
#include "sim/input/subroutine_files.h"
#include "sim/model/machine.h"
#include "sim/model/scenario.h"

namespace servomill::sim::preparation {

controllers::ProgramText program_text(const model::ProgramSpec& program) {
  return controllers::ProgramText::of_shared_text(program.shared_text, program.file);
}

AxisWords machine_start(const model::Scenario& scenario, const model::CaseSpec& spec) {
  return scenario.program.start + scenario.program.work_offset + spec.work_offset;
}

controllers::ProgramSetup program_setup(const model::Scenario& scenario,
                                        const model::CaseSpec& spec) {
  controllers::ProgramSetup setup;
  setup.parameters = scenario.program.parameters;
  setup.work_offset[0] = scenario.program.work_offset + spec.work_offset;
  setup.tools = scenario.program.tools;
  setup.reader = scenario.program.reader;
  setup.decimal_point = scenario.program.decimal_point;
  setup.feed = scenario.program.first_feed;
  setup.ignored_codes = scenario.program.ignored_codes;
  setup.start = machine_start(scenario, spec);
  setup.machine = tool_centre_point(scenario.machine_of(spec));
  setup.subroutine_file = [texts = scenario.program.subroutines, file = scenario.program.file](
                              const std::string& name) -> std::optional<controllers::ProgramText> {
    const auto found = texts.find(name);
    if (found == texts.end()) return std::nullopt;
    return controllers::ProgramText::of_text(found->second, input::subroutine_file(file, name));
  };
  return setup;
}

std::shared_ptr<const controllers::ToolCentrePoint> tool_centre_point(
    const model::MachineSettings& machine) {
  return std::make_shared<const controllers::ToolCentrePoint>(
      machine.chain, machine.nc.lower, machine.nc.upper,
      controllers::kGreatCircleShare * machine.nc.rotary_tolerance);
}

std::map<int, Eigen::Vector3d> tips_of(const MoveList& moves, const controllers::ToolTable& tools) {
  std::map<int, Eigen::Vector3d> tips = {{0, Eigen::Vector3d::Zero()}};
  for (const Move& move : moves) {
    if (const auto* tool = tools.find(move.tool_offset)) {
      tips[move.tool_offset] = -tool->offset.head<3>();
    }
  }
  return tips;
}

controllers::PathOptions path_options(const model::NcSettings& nc, double feed_override) {
  controllers::PathOptions options;
  options.tolerance = nc.path_tolerance;
  options.rotary_tolerance = nc.rotary_tolerance;
  options.feed_override = feed_override;
  options.block_time = nc.block_time;
  options.tolerance_share = nc.tolerance_share;
  if (nc.spindle) options.spindle_acceleration = nc.spindle->acceleration;
  return options;
}

MoveList read_program(const model::Scenario& scenario, const model::CaseSpec& spec,
                      std::vector<Fault>* warnings,
                      const std::function<std::shared_ptr<controllers::Probed>()>& probed) {
  const model::ProgramSpec& program = scenario.program;
  const auto setup = [&] {
    controllers::ProgramSetup out = program_setup(scenario, spec);
    if (probed) out.probed = probed();
    return out;
  };
  try {
    controllers::Interpreter interpreter(program_text(program), setup());
    MoveList moves = interpreter.rest_held();
    if (warnings != nullptr) {
      warnings->insert(warnings->end(), interpreter.warnings().begin(),
                       interpreter.warnings().end());
    }
    return moves;
  } catch (const InputError&) {  // stopped at the first fault; the user wants all of them
    auto faults = controllers::check_program(program_text(program), setup());
    if (faults.empty()) throw;
    throw InputError(std::move(faults));
  }
}

}  // namespace servomill::sim::preparation

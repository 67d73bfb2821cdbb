#include "sim/programs/placed_program.h"

#include <memory>
#include <utility>

#include "plant/vocabulary/interrupt.h"
#include "sim/input/machine_description.h"
#include "sim/preparation/case_program.h"
#include "sim/programs/compensate/work_knowledge.h"
#include "sim/programs/line_stage.h"

namespace servomill::sim::programs {

void PlacedProgram::begin_at(const AxisWords& start) {
  is_start_known = true;
  given.setup.start = start;
  given.setup.accepts_unknown_positions = false;
}

PlacedProgram placed_program(const ProgramPlacement& placement) {
  PlacedProgram out;
  const input::MachineDescription described =
      input::read_machine_description(placement.inputs.machine, placement.changes);
  out.machine = *described.machine;
  out.has_drives = described.has_drives;
  const JointLayout& layout = out.machine.chain.layout;
  out.given = given_setup(placement.program_file, placement.inputs, placement.work_offsets,
                          placement.tool_lengths, &layout);
  controllers::ProgramSetup& setup = out.given.setup;
  setup.machine = preparation::tool_centre_point(out.machine);
  choose_reader(placement.inputs, out.machine.nc, setup);
  if (!placement.start.empty()) {
    out.begin_at(axis_values("--start", placement.start, &layout, false).words);
  } else {
    setup.start[index_of(Axis::Z)] = kSomeHeight;
    setup.accepts_unknown_positions = true;
  }
  if (setup.tools.empty()) setup.tools.take_any_number();
  setup.accepts_unknown_dwells = true;
  setup.probed = std::make_shared<controllers::AssumedContact>();
  return out;
}

std::vector<Fault> read_blocks(
    const std::string& program_file, const controllers::ProgramSetup& setup,
    const std::function<void(const controllers::ExecutedBlock& block)>& take) {
  const auto text = [&] { return controllers::ProgramText::of_file(program_file); };
  LineStage lines(program_file);
  controllers::Interpreter interpreter(text(), setup);
  try {
    while (const auto block = interpreter.next_block()) {
      throw_if_interrupted();
      lines.at(block->line);
      take(*block);
    }
  } catch (const InputError&) {  // stopped at the first fault; the user wants all of them
    auto faults = controllers::check_program(text(), setup);
    if (faults.empty()) throw;
    throw InputError(std::move(faults));
  }
  return interpreter.warnings();
}

}  // namespace servomill::sim::programs

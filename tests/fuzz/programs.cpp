#include "tests/fuzz/programs.h"

#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"
#include "tests/fuzz/fuzz.h"

namespace servomill::fuzz {
namespace {

std::shared_ptr<const controllers::ToolCentrePoint> trunnion() {
  plant::MachineChain chain = plant::make_chain(plant::parse_structure("[w C' A' X' b Y Z t]"));
  chain.at(Axis::A).centre = Eigen::Vector3d(0.0, 0.0, -60.0 * mm);
  chain.at(Axis::C).centre = Eigen::Vector3d(0.0, 1.0 * mm, 0.0);
  Joints upper = Joints::Constant(1e3);
  upper[3] = 120.0 * deg;
  return std::make_shared<controllers::ToolCentrePoint>(
      chain, -upper, upper, controllers::kGreatCircleShare * 100.0 * urad);
}

}  // namespace

controllers::ProgramSetup setup_for(std::string_view program) {
  static const auto kMachine = trunnion();
  static const auto kTools =
      controllers::ToolTable::parse("T1 P1 Z100 D8\nT3 P3 X0.5 Y-0.25 Z33 A2 D10\n", "tools.tbl");
  controllers::ProgramSetup setup;
  setup.tools = kTools;
  setup.parameters = {{"#101", 1394.0}, {"#<depth>", -2.5}, {"#<_allowance>", 0.25}};
  setup.work_offset[1] << -10 * mm, 20 * mm, 30 * mm, 0.0, 0.0, 90 * deg;
  setup.work_rotation[1] = 0.25;
  setup.start << 5 * mm, 6 * mm, 7 * mm, 0.0, 0.0, 0.0;
  setup.block_delete = program.size() % 2 == 1;
  if (program.size() % 4 < 2) setup.machine = kMachine;
  return setup;
}

Outcome moves_until_fault(std::string_view program, const controllers::ProgramSetup& setup) {
  Outcome out;
  controllers::Interpreter interpreter(std::string(program), std::string(kProgram), setup);
  try {
    while (out.moves.size() < kMostMoves) {
      auto move = interpreter.next();
      if (!move) break;
      out.moves.push_back(std::move(*move));
    }
  } catch (const InputError& error) {
    require_places(error.faults(), program, kProgram);
    out.has_fault = true;
  }
  return out;
}

}  // namespace servomill::fuzz

#include "tests/fuzz/programs.h"

#include <map>

#include "plant/kinematics/structure.h"
#include "plant/vocabulary/units.h"
#include "tests/fuzz/fuzz.h"

namespace servomill::fuzz {
namespace {

constexpr long kMaxJumps = 300;

std::shared_ptr<const controllers::ToolCentrePoint> trunnion() {
  plant::MachineChain chain = plant::make_chain(plant::parse_structure("[w C' A' X' b Y Z t]"));
  chain.at(Axis::A).centre = Eigen::Vector3d(0.0, 0.0, -60.0 * mm);
  chain.at(Axis::C).centre = Eigen::Vector3d(0.0, 1.0 * mm, 0.0);
  Joints upper = Joints::Constant(1e3);
  upper[3] = 120.0 * deg;
  return std::make_shared<controllers::ToolCentrePoint>(
      chain, -upper, upper, controllers::kGreatCircleShare * 100.0 * urad);
}

// Name and text of the subroutine files.
using Files = std::map<std::string, std::string, std::less<>>;
const Files& subroutine_files() {
  static const Files kFiles = {
      {"side", "o<side> sub\nG91 G1 X#1 F[100 + #2]\nG90\no<side> endsub [#1 + 1]\nM2\n"},
      {"100", "G0 X1\nM98 P200 L2\nM99\nO200\nG0 Y1\nM99\n"}};
  return kFiles;
}

std::optional<controllers::ProgramText> subroutine_file(const std::string& name) {
  const auto found = subroutine_files().find(name);
  if (found == subroutine_files().end()) return std::nullopt;
  return controllers::ProgramText::of_text(found->second, name);
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
  setup.subroutine_file = subroutine_file;
  setup.most_jumps = kMaxJumps;
  return setup;
}

void require_program_places(std::span<const Fault> faults, std::string_view program) {
  for (const Fault& fault : faults) {
    const auto file = subroutine_files().find(fault.place.file);
    if (file == subroutine_files().end()) {
      require_places(std::span(&fault, 1), program, kProgram);
    } else {
      require_places(std::span(&fault, 1), file->second, file->first);
    }
  }
}

std::vector<Move> moves_until_fault(std::string_view program,
                                    const controllers::ProgramSetup& setup) {
  std::vector<Move> moves;
  controllers::Interpreter interpreter(std::string(program), std::string(kProgram), setup);
  try {
    while (moves.size() < kMaxMoves) {
      const Move* move = interpreter.next();
      if (move == nullptr) break;
      moves.push_back(*move);
    }
  } catch (const InputError& error) {
    require_program_places(error.faults(), program);
  }
  return moves;
}

}  // namespace servomill::fuzz

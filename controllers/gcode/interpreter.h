/// The RS274/NGC interpreter: program text in, canonical moves out.
///
/// Meaning and order of execution are those of LinuxCNC 2.9: within a block, whatever the order of
/// its words, (1) messages, (2) G93 G94, (3) F, in the unit in force before the block, (4) S,
/// (5) T, (6) M6, (7) M3 M4 M5, (8) M7 M8 M9, (9) M48 M49, (10) G4, (11) plane, (12) unit,
/// (13) cutter compensation, (14) tool length, (15) work system, (16) path control, (17) distance
/// modes, (18) G10 G28 G30 G52 G92, (19) motion, (20) M0 M1 M2 M30. Parameters set in a block take
/// effect after all its words are read. A block with an error changes nothing.
///
/// Different from LinuxCNC on purpose: M6 leaves the position as it
/// is; M48 M49 do nothing, since no operator turns the override; all messages of a block are given,
/// not only its last; a G0 or G1 without axis words gives no move; Q of G64 is accepted and unused
/// (it allows, and does not ask for, the merging of short lines).
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "controllers/gcode/tool_table.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/move.h"

namespace servomill::controllers {

/// What the machine knows before the first block.
struct ProgramSetup {
  /// "#101", "#<name>" or "#<_name>", in program terms (whatever unit the program gives them).
  std::map<std::string, double> parameters;
  std::array<AxisWords, 9> work_offset = zero_offsets();  // G54 ... G59.3; m, rad
  std::array<double, 9> work_rotation{};                  // about Z, rad
  int work_system = 1;                                    // in force at the start; 1 is G54
  ToolTable tools;
  int tool = 0;                         // in the spindle at the start; 0: none
  AxisWords start = AxisWords::Zero();  // machine coordinates before the first block; m, rad
  bool block_delete = false;            // leave out the lines that start with '/'

  static std::array<AxisWords, 9> zero_offsets();
};

/// Reads a program block by block, so that a long one is never held as moves.
class Interpreter {
 public:
  /// @param file  name for messages
  /// @throws InputError for parameters that cannot be set
  Interpreter(std::string text, std::string file, ProgramSetup setup);
  ~Interpreter();
  Interpreter(Interpreter&&) noexcept;
  Interpreter& operator=(Interpreter&&) noexcept;

  /// The next move, or nullopt behind the end of the program.
  /// @throws InputError at a block with an error, which then has changed nothing; the call after
  /// that goes on with the next block
  std::optional<Move> next();

  /// All moves that are left.
  /// @throws InputError at a block with an error; the moves before it are lost
  std::vector<Move> rest();

 private:
  class Machine;
  std::unique_ptr<Machine> machine_;
};

/// All moves of a program. `s_begin` and `s_end` count the length of the XYZ path in work
/// coordinates, helices included; a move of rotary axes only has none.
std::vector<Move> interpret(std::string text, std::string file, ProgramSetup setup);

/// Every fault of syntax in the program (up to its end), and the first fault met on running it.
std::vector<Fault> check_program(std::string text, std::string file, ProgramSetup setup);

}  // namespace servomill::controllers

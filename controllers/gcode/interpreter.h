/// The RS274/NGC interpreter: program text in, canonical moves out.
///
/// Meaning and order of execution are those of LinuxCNC 2.9: within a block, whatever the order of
/// its words, (1) message, (2) G93 G94 G95, (3) F, in the unit in force before the block, (4) S,
/// (5) T, (6) M6, (7) M3 M4 M5, M70 ... M73, (8) M7 M8 M9, (9) M48 ... M53, (10) G4, (11) plane,
/// (12) unit, (13) cutter compensation, (14) tool length and tool-centre-point control, (15) work
/// system, (16) tilted work plane, (17) path control, (18) distance modes, G98 G99, (19) G10 G28
/// G30 G52 G53.1 G92, (20) motion, (21) M0 M1 M2 M30 M60 M99. Parameters set in a block take effect
/// after all its words are read. A block with an error changes nothing.
///
/// Additions to LinuxCNC, in the manner of Fanuc's 30i series:
///   G43.4 H    tool-centre-point control: X Y Z are the tip in the workpiece, which turns with the
///              table; rotary axes go linearly to their words. Group of G43, ended by its others.
///   G43.5 H    the same; I J K of G0 and G1 are the tool axis, from the tip to the spindle, in the
///              coordinates of the program. It turns on a great circle. A block without I J K keeps
///              it. Words of rotary axes and arcs are errors.
///   G68.2 X Y Z I J K   tilted work plane: origin in work coordinates and Euler angles (degrees)
///              about Z, the new X, the new Z: R = Rz(I) Rx(J) Rz(K). What is left out is 0.
///   G53.1      turns the rotary axes at rapid so that the tool stands along Z of that plane, the
///              nearest of the solutions within the travel; the linear axes stand still.
///   G69        ends the tilted work plane.
/// While one of them controls the tip, the origin is that of the work system as it lies with all
/// rotary axes at zero, and turns with the workpiece. Switching them on or off moves nothing.
///
/// Cutter compensation (G41 G42 G41.1 G42.1, cutter_compensation.h) holds a move back until the
/// next one is known; what stands between them comes between them, but messages come at once. Moves
/// are of the line that programmed them, an arc around a corner of the line of the move behind it;
/// `s_begin` and `s_end` count the programmed path. #5420 ... and #<_x> are where the tool is, and
/// expressions may not read the former until G40.
///
/// Different from LinuxCNC on purpose: a change of unit under cutter compensation leaves feeds and
/// the test against gouging as they are (there, what waits for the next move is scaled wrongly); M6
/// takes over where the tool is after G40, and leaves any other position as it is; M48 ... M53 only
/// set parameters like
/// #<_feed_override>, since no operator turns the override; Q of G64
/// is accepted and unused (it allows, and does not ask for, the merging of short lines); words in
/// the block of M98 other than P and L are warned of; M99 behind other words is refused in a
/// subprogram before the motion in its block, not after; a dwell is not negative; a block makes at
/// most 100000 moves (cycles with tiny pecks).
///
/// Probing moves ask `ProgramSetup::probed` where the probe switches (probing.h).
///
/// O-words: subroutines, loops and conditions as LinuxCNC has them, its oddities included (the
/// notes at FlowState in flow_state.h); where a program is skipped, only comments, labels
/// and keywords are looked at.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/gcode/block.h"
#include "controllers/gcode/program_setup.h"
#include "controllers/gcode/program_text.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/move_list.h"

namespace servomill::controllers {

struct ModalState;
struct PlaneFrame;
struct Request;

/// A line of a program that was run: also a blank one, and one that O-words skip.
struct ExecutedBlock {
  std::string_view text;         // as it stands in the file, without its end
  const Block* block = nullptr;  // with its pieces and values; nullptr: blank, or skipped
  std::span<const Move> moves;   // may hold moves of earlier lines, which waited for this one
  const std::string* file = nullptr;
  int line = 0;
  int call_depth = 0;                 // 0: outside of subroutines
  bool is_repeated = false;           // the program has turned back over this line
  const Request* request = nullptr;   // with numbers in place of expressions; nullptr: no words
  const ModalState* state = nullptr;  // behind the block
  const PlaneFrame* frame = nullptr;  // behind the block
  /// Number (0 for a named one) and new value of the parameter of each assignment.
  std::span<const std::pair<int, double>> assigned = {};
  /// Cycle whose moves a survey does not know, with the block as their placeholder: "CYCL DEF
  /// 251".
  std::string_view unknown_moves = {};
};

/// Reads a program block by block, so that a long one is never held: neither its text nor its
/// moves.
class Interpreter {
 public:
  /// @throws InputError for parameters that cannot be set
  Interpreter(ProgramText text, ProgramSetup setup);
  /// @param file  name for messages
  Interpreter(std::string text, std::string file, ProgramSetup setup);
  ~Interpreter();
  Interpreter(Interpreter&&) noexcept;
  Interpreter& operator=(Interpreter&&) noexcept;

  /// The next move, or nullptr behind the end of the program. It stays valid until the next call.
  /// @throws InputError at a block with an error, which then has changed nothing; the call after
  /// that goes on with the next block
  const Move* next();

  /// The next line with its moves, or nullopt behind the end of the program. What it points to
  /// stays valid until the next call. Not to be mixed with `next`.
  /// @throws InputError as next()
  std::optional<ExecutedBlock> next_block();

  /// All moves that are left.
  /// @throws InputError at a block with an error; the moves before it are lost
  std::vector<Move> rest();
  /// The same, held compactly.
  MoveList rest_held();

  /// Warnings of the blocks so far: tool axes that were not of unit length,
  /// tools that cut in a tilted plane without standing along its Z.
  const std::vector<Fault>& warnings() const;
  /// Line of the closing '%' that ended the program although blocks follow it; 0: none did.
  int unread_behind() const;

 private:
  class Machine;
  std::unique_ptr<Machine> machine_;
};

/// All moves of a program. `s_begin` and `s_end` count the length of the XYZ path in work
/// coordinates, helices included; a move of rotary axes only has none.
std::vector<Move> interpret(std::string text, std::string file, ProgramSetup setup);

/// Every fault of syntax in the program (up to its end), and the first fault met on running it;
/// behind an M code of the machine's builder the next as well.
/// @param warnings  receives what the interpreter reports, or nullptr
std::vector<Fault> check_program(ProgramText text, ProgramSetup setup,
                                 std::vector<Fault>* warnings = nullptr);
std::vector<Fault> check_program(std::string text, std::string file, ProgramSetup setup);

}  // namespace servomill::controllers

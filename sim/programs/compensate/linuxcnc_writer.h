/// Weaves corrected moves into the text of a program for LinuxCNC: what is not motion stays as it
/// stands, word by word.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "sim/programs/compensate/program_corrector.h"
#include "sim/programs/compensate/program_writer.h"

namespace servomill::sim::programs {

struct EditedLine;

/// Positions are written in the units, the distance mode and the work coordinates that the program
/// has there: blocks that change them stay. Words whose value does not change keep their spelling.
/// - A line with one block of motion keeps its form; lines that follow it hold motion only. Codes
///   that act behind the motion (M0, M1, M2, M30, M60) come behind the last.
/// - Expressions become numbers, lines with O-words go, canned cycles and cutter compensation
///   become their moves.
/// - Moves of canned cycles run under G61, as the cycles do (interp_cycles.cc, convert_cycle);
/// behind
///   them the mode of the program is restored.
/// - G92 and G10 L10, L11, L20 state the position of the machine: they get the corrected one.
/// - A line that starts with '/' and moves or changes modes is refused: what follows relies on it.
///   One that the interpreter leaves out becomes a comment.
/// - Rotary axes alone keep their time where X, Y and Z now move by micrometres (G93 for
///   the block).
class LinuxCncWriter final : public ProgramWriter {
 public:
  /// @param decimals  of millimetres; inches get two more, so that they are no coarser
  LinuxCncWriter(ProgramCorrector& corrector, Summary& summary, int decimals);
  ~LinuxCncWriter() override;

  void write(const controllers::ExecutedBlock& block) override;
  std::string finish(const std::vector<std::string>& header) override;
  std::vector<std::string> assumptions() const override;

 private:
  using Block = controllers::ExecutedBlock;

  void put(std::string_view text);
  void put(const EditedLine& line);
  void put_beside(const EditedLine& line, std::string_view text);
  void forget_motion_code(const EditedLine& line);
  bool take_percent(const Block& block);
  void move(const Block& block);
  void move(const Move& one, const Block& block, bool is_place);
  void put_cycle_step(const Move& one, const Block& block, const EditedLine& line);
  void note_path_mode(const Block& block);
  void begin_exact_path(const Move& one, const Block& block, const EditedLine& line);
  void end_exact_path();
  void release_until(int line);
  void release(EditedLine& line);
  void write_step(const Step& step, EditedLine& line, bool is_woven_in);
  void shift_position(const Block& block, EditedLine& line) const;
  void note_motion_code(const EditedLine& line);

  ProgramCorrector& corrector_;
  Summary& summary_;
  int decimals_;
  std::string text_, end_of_line_ = "\n";
  std::size_t header_at_ = 0;
  bool is_first_ = true, is_open_ = false;  // no line yet; behind a '%'
  std::string motion_;                      // code in force in the output; empty: none
  bool compensates_cutter_ = false;
  bool says_path_ = false, assumes_G64_ = false;  // the program has named its path mode
  double naive_cam_tolerance_ = -1.0;             // m, Q of G64; < 0: not given
  std::string path_behind_cycle_;                 // to be restored; empty: in force
  std::deque<EditedLine> waiting_;                // lines whose motion may still come
};

}  // namespace servomill::sim::programs

/// Canonical moves back to program text.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/move.h"

namespace servomill::controllers {

/// `Move::number` of a message that is printed as it is: a line of the program. Work system, tool
/// length, path control, S, F and positions are restated after it.
inline constexpr int kProgramLine = 2;

struct PrintOptions {
  int decimals_mm = 7;                  // of X Y Z I J K
  int decimals_deg = 7;                 // of A B C
  std::string axes = "XYZABC";          // axes of the machine; others are printed only if they move
  bool tcp_control = false;             // G43.4 in place of G43: `end` is the tip in the workpiece
  AxisWords start = AxisWords::Zero();  // machine coordinates before the first move; m, rad
};

/// Prints a program move after move, as print_program() does.
class ProgramPrinter {
 public:
  /// Takes one line after the other, without its end.
  using TakeLine = std::function<void(std::string_view line)>;

  /// Prints the header.
  ProgramPrinter(const PrintOptions& options, std::string_view header, TakeLine take);
  ~ProgramPrinter();
  ProgramPrinter(const ProgramPrinter&) = delete;
  ProgramPrinter& operator=(const ProgramPrinter&) = delete;

  void print(const Move& move);
  /// To be called once, after the last move.
  void finish();

 private:
  class Printer;
  std::unique_ptr<Printer> printer_;
};

struct PrintedProgram {
  std::string text;
  std::vector<int> move_of_line;  // for line k (from 1) at k - 1: index of its move, -1 for none
};

/// Program that interprets to the same moves, to print precision, under the same work offsets,
/// tools and start: millimetres, absolute, incremental arc centres, G94 or G93 as the moves say.
/// Words that do not change are left out; the first motion, and the first after a change of work
/// or tool offset, names all axes. Ends with M30, whether the moves end with `end` or not.
/// An arc so short that its ends print alike becomes a line (it would read as a full circle).
/// @param header  becomes comments, one a line
/// @throws InputError for a tool offset that does not come from the tool table (G43.1, G43.2)
PrintedProgram print_program(std::span<const Move> moves, const PrintOptions& options,
                             std::string_view header);

}  // namespace servomill::controllers

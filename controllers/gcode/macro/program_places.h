/// Places in macro programs: the programs of a file, block numbers, and the loops.
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "controllers/gcode/macro/line.h"
#include "controllers/gcode/program_text.h"

namespace servomill::controllers::macro {

/// WHILE DO and END. Source: Fanuc B-63944EN, repetition (from memory): numbers 1 to 3, pairs in
/// each other up to three deep, no jump into a loop.
struct Loop {
  int number = 0;
  ProgramText::Mark begin;   // before the line of WHILE
  ProgramText::Mark behind;  // the line of END
  int begin_line = 0, end_line = 0;
  std::string fault;  // why it is none
};

/// A file, and what its lines lead to. It is looked through where the program first asks.
class ProgramPlaces {
 public:
  ProgramPlaces(ProgramText text, bool skips_optional)
      : text_(std::move(text)), skips_optional_(skips_optional) {}

  ProgramText& text() { return text_; }
  const ProgramText& text() const { return text_; }
  /// Before the line O of that number.
  std::optional<ProgramText::Mark> program(long number);
  /// Before the line N of that number: the next one behind the line handed out last, else the first
  /// of the program that this line is of.
  std::optional<ProgramText::Mark> block(long number);
  /// The loop that begins or ends in that line, or nullptr.
  const Loop* loop_from(int line);
  const Loop* loop_to(int line);
  /// The innermost loop that holds one line and not the other, or nullptr.
  const Loop* loop_entered(int from_line, int to_line);

 private:
  struct Program {
    long number = -1;
    ProgramText::Mark begin;
  };
  void look_through();
  void add_loop_line(const Line& line, const ProgramText::Mark& before, int number,
                     std::vector<std::size_t>& open);
  std::optional<ProgramText::Mark> find_block(long number, const ProgramText::Mark& from,
                                              std::uint64_t until);

  ProgramText text_;
  bool skips_optional_;
  bool is_known_ = false;
  std::vector<Program> programs_;
  std::vector<Loop> loops_;
  std::map<int, std::size_t> loop_begins_, loop_ends_;  // by line
  std::map<std::pair<std::uint64_t, long>, std::optional<ProgramText::Mark>> blocks_;
};

}  // namespace servomill::controllers::macro

/// A line of a program and the words that it gets in place of those of its motion.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "controllers/gcode/interpreter.h"
#include "controllers/gcode/request.h"
#include "plant/vocabulary/units.h"
#include "sim/programs/compensate/line_tokens.h"
#include "sim/programs/compensate/summary.h"

namespace servomill::sim::programs {

/// A line with its pieces as they will be written, and the modes that its motion is written in.
struct EditedLine {
  std::string file;
  int number = 0;
  std::string text;
  std::vector<LineToken> pieces;
  std::vector<const controllers::Code*> codes;  // of each piece, where it is a G or M code
  std::vector<std::string> words;               // of each piece; empty: it goes
  std::string behind;  // codes that act behind the motion, where they do not fit in
  std::array<double, controllers::kWordLetters> values{};  // of words, in program units
  std::array<bool, controllers::kWordLetters> has{}, is_constant{};
  bool is_motion = false;  // has words that its moves take
  bool is_cycle = false;
  std::string letters;  // of such words
  bool is_released = false;

  double unit = mm;
  bool is_incremental = false, is_centre_absolute = false;
  FeedMode feed_mode = FeedMode::units_per_minute;
  double feed_linear = 0.0;  // m/s

  double value(char letter) const { return values[controllers::word_index(letter)]; }
  bool has_word(char letter) const { return has[controllers::word_index(letter)]; }
  bool is_constant_word(char letter) const { return is_constant[controllers::word_index(letter)]; }
};

/// The words that a block of motion has.
struct MotionWords {
  std::string code;    // G0 ... G3
  std::string prefix;  // G93 where the block needs it
  std::vector<std::pair<char, std::string>> words;
  std::string kept;  // letters of words that stay as they are written

  std::string text(bool with_code) const;
};

/// A block as it stands, expressions replaced by numbers and messages by what they said.
EditedLine line_of(const controllers::ExecutedBlock& block, Summary& summary);

bool has_slash(const EditedLine& line);
bool has_o_word(const EditedLine& line);
bool is_empty(const EditedLine& line);
bool is_motion_word(const EditedLine& line, std::size_t i);
bool is_motion_code(const EditedLine& line, std::size_t i);

/// Letters that belong to motion: those of its axes, and what arcs and cycles take.
std::string motion_letters(const controllers::ExecutedBlock& block);

/// Takes piece i out, with the blank before it.
void drop(EditedLine& line, std::size_t i);
/// The operator's switch must not decide about a line that changes what follows.
/// @throws InputError
void refuse_slash(const EditedLine& line);
inline constexpr std::string_view kSlash =
    "the rest of the program depends on whether the operator skips blocks with '/'; remove the "
    "slash, or omit these blocks with --block-delete";
/// Everything but comments that no one hears.
void drop_o_words(EditedLine& line);
void drop_motion(EditedLine& line);
/// Takes what acts behind the motion out of a line whose motion needs more lines.
void take_behind(EditedLine& line);

/// Puts a word before those of motion; there is one at least.
void insert(EditedLine& line, std::string_view word);
/// Replaces the words of motion of a line.
void weave(EditedLine& line, MotionWords motion, bool needs_code);

}  // namespace servomill::sim::programs

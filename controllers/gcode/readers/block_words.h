/// Words of a block that the rules of a control change, and the line that says the same to
/// LinuxCNC. What no rule changes stays as it is written.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/gcode/block.h"
#include "controllers/gcode/rewritten_line.h"

namespace servomill::controllers {

/// One word of a block.
struct BlockWord {
  char letter = '\0';
  double value = 0.0;
  int column = 0;                  // in the line as written; of an added word that of its cause
  bool has_point = false;          // written with a decimal point
  bool is_literal = false;         // a number, no expression
  int digits = 0;                  // of a literal
  std::size_t begin = 0, end = 0;  // in the line; equal: added by a rule
  bool is_erased = false, is_changed = false;
  bool is_kept_as_comment = false;  // of an erased word
};

class BlockWords {
 public:
  using Evaluate = std::function<double(const Value&)>;

  /// @param block  parsed from `line`, with its pieces
  BlockWords(std::string_view line, const Block& block, const Evaluate& evaluate);

  /// The word with that letter, or nullptr; of G and M the first.
  BlockWord* find(char letter);
  const BlockWord* find(char letter) const;
  bool has(char letter) const { return find(letter) != nullptr; }
  /// @pre has(letter)
  double operator[](char letter) const { return find(letter)->value; }
  int column(char letter) const { return find(letter) == nullptr ? 0 : find(letter)->column; }
  /// The code G59.1 is ('G', 591), or nullptr.
  BlockWord* code(char letter, int tenths);
  const BlockWord* code(char letter, int tenths) const;
  bool has_code(char letter, int tenths) const { return code(letter, tenths) != nullptr; }
  /// X, Y, Z, A, B or C, or a polar coordinate of LinuxCNC.
  bool has_axis() const;

  void erase(BlockWord& word);
  void erase(char letter);
  /// Erases the word but for a comment, so that whoever reads the line sees what it had.
  void comment_out(BlockWord& word);
  void set(char letter, double value, int column = 0);
  void add(char letter, double value, int column);

  std::vector<BlockWord>& all() { return words_; }
  const std::vector<BlockWord>& all() const { return words_; }
  bool is_changed() const;

  /// The line with its changes.
  std::string text() const;
  /// Column in the line as written of one in `text()`.
  int original_column(int column) const { return written_.original_column(column); }

 private:
  void write() const;

  std::string line_;
  std::vector<BlockWord> words_;
  std::size_t insert_at_ = 0;  // in the line: behind its last word
  mutable RewrittenLine written_;
};

/// Ten times a code, or -1 if there can be none.
int tenths_of(double code);

/// As a word has it: with a decimal point where controls take a P without one as another unit.
std::string word_text(char letter, double value);

}  // namespace servomill::controllers

/// Blocks and words of Heidenhain conversational programs.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {

/// One word: "X+10", "IPA-90", "FMAX", "Q339=+1". Words end at white space,
/// and the function of "FN 0:Q1=5" at its colon.
struct HeidenhainWord {
  std::string text;
  std::string address;  // letters at its start
  std::string rest;     // characters after the address
  Place place;
};

/// One block: a line and its continuation lines.
struct HeidenhainBlock {
  Place place;  // of its first word, or of its line
  std::optional<long> number;
  bool is_optional = false;           // begins with '/'
  bool is_continued_comment = false;  // a comment with further lines
  std::vector<HeidenhainWord> words;
};

/// Splits a text into blocks, one at a time. An empty line is not a block; a block that consists of
/// a comment has no words.
class HeidenhainBlocks {
 public:
  /// @param text        must outlive this
  /// @param first_line  number of the line before it
  /// @param continues_comments  lines after a comment that ends with '~' belong to it; otherwise
  ///                            they are refused
  HeidenhainBlocks(std::string_view text, std::string file, int first_line = 0,
                   bool continues_comments = false);
  /// The next block, nullopt at the end.
  /// @throws InputError for a control character, for a continuation without a next line
  std::optional<HeidenhainBlock> next();
  /// Number of the line read last, from 1.
  int line() const { return line_; }
  /// Text not yet read.
  std::string_view rest() const { return rest_; }

 private:
  struct Line;
  Line take_line();

  std::string_view rest_;
  std::string file_;
  int line_ = 0;
  bool continues_comments_ = false;
};

/// Bounds of a number: the control's input format.
struct HeidenhainFormat {
  double max = 0.0;
  int decimals = 0;
  bool has_sign = true;
};

/// The number that follows the address of a word; "10.5" and "10,5" are the same.
/// @throws InputError
double heidenhain_number(const HeidenhainWord& word, std::string_view digits,
                         const HeidenhainFormat& format);

}  // namespace servomill::controllers

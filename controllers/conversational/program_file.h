/// A conversational program in a file: its text and the positions of its labels.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "controllers/dialects/heidenhain_block.h"

namespace servomill::controllers::conversational {

/// Position in the text at the start of a block.
struct BlockMark {
  std::size_t offset = 0;
  int line = 0;  // number of the line before
  bool operator==(const BlockMark&) const = default;
};

/// Reads the blocks of a program in order and jumps to any of them. The whole text is kept, since a
/// jump may lead anywhere.
class ProgramFile {
 public:
  ProgramFile(std::string text, std::string file);

  /// The next block, nullopt at the end of the text.
  /// @throws InputError
  std::optional<HeidenhainBlock> next();
  /// The first block with words, from the start of the text.
  std::optional<HeidenhainBlock> begin();
  BlockMark mark() const { return at_; }
  void go_to(const BlockMark& mark) { at_ = mark; }
  /// Position after the LBL block of that label; nullptr if there is none.
  const BlockMark* find_label(const std::string& label) const;
  const std::string& file() const { return file_; }
  int line() const { return at_.line; }
  /// Faults found without running the program: labels that appear twice, control characters.
  const std::vector<Fault>& faults() const { return faults_; }
  /// Blocks TOOL DEF with numbers only, which define a tool in the program.
  const std::vector<HeidenhainBlock>& tool_definitions() const { return tool_definitions_; }
  /// Lines in brackets before BEGIN PGM, which are not read.
  int lines_before_begin() const { return lines_before_begin_; }
  /// True if block numbers are written with N.
  bool has_numbers_with_N() const { return has_numbers_with_N_; }
  /// True if blocks end with a comment in brackets.
  bool has_bracket_comments() const { return has_bracket_comments_; }
  /// Programs that it calls, by the names written in the blocks.
  const std::vector<std::string>& called_programs() const { return called_; }

 private:
  void blank_title();
  void take_number_with_N(HeidenhainBlock& block);
  void drop_bracket_comment(HeidenhainBlock& block);
  void index();
  void index(const HeidenhainBlock& block);

  std::string text_, file_;
  BlockMark at_;
  int lines_before_begin_ = 0;
  bool has_numbers_with_N_ = false, has_bracket_comments_ = false;
  std::map<std::string, BlockMark> labels_;
  std::vector<Fault> faults_;
  std::vector<HeidenhainBlock> tool_definitions_;
  std::vector<std::string> called_;
};

/// The label in the words after LBL: a number without leading zeros, or a name in quotation marks.
std::string label_of(std::span<const HeidenhainWord> words);

/// The name of a program without folder and extension: "TNC:\PARTS\HOLE.H" is HOLE.
std::string program_name(std::string_view text);

}  // namespace servomill::controllers::conversational

/// A conversational program in a file: its text, and where its labels are.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "controllers/dialects/heidenhain_block.h"

namespace servomill::controllers::conversational {

/// A place in the text: before a block.
struct BlockMark {
  std::size_t offset = 0;
  int line = 0;  // number of the line before
  bool operator==(const BlockMark&) const = default;
};

/// Hands out the blocks of a program, and goes to any of them. The text is held: a jump may go
/// anywhere.
class ProgramFile {
 public:
  ProgramFile(std::string text, std::string file);

  /// The next block, nullopt at the end of the text.
  /// @throws InputError
  std::optional<HeidenhainBlock> next();
  /// The first block with words, from the begin of the text.
  std::optional<HeidenhainBlock> begin();
  BlockMark mark() const { return at_; }
  void go_to(const BlockMark& mark) { at_ = mark; }
  /// Behind the block LBL of that label; nullptr: there is none.
  const BlockMark* find_label(const std::string& label) const;
  const std::string& file() const { return file_; }
  int line() const { return at_.line; }
  /// Labels that stand twice, and control characters: every fault that needs no run.
  const std::vector<Fault>& faults() const { return faults_; }
  /// Blocks TOOL DEF with numbers only, which define a tool in the program.
  const std::vector<HeidenhainBlock>& tool_definitions() const { return tool_definitions_; }
  /// The programs that it calls, as they are named.
  const std::vector<std::string>& called_programs() const { return called_; }

 private:
  void index();
  void index(const HeidenhainBlock& block);

  std::string text_, file_;
  BlockMark at_;
  std::map<std::string, BlockMark> labels_;
  std::vector<Fault> faults_;
  std::vector<HeidenhainBlock> tool_definitions_;
  std::vector<std::string> called_;
};

/// The label of the words behind LBL: a number without leading zeros, or a name in quotation marks.
std::string label_of(std::span<const HeidenhainWord> words);

/// The name of a program without folder and extension: "TNC:\PARTS\HOLE.H" is HOLE.
std::string program_name(std::string_view text);

}  // namespace servomill::controllers::conversational

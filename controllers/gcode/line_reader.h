/// Lines of programs, read by the rules of a reader.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "controllers/gcode/parser.h"
#include "controllers/gcode/reader.h"

namespace servomill::controllers {

/// ",R5." or ",C2.": the corner to the next block is rounded or chamfered.
struct CornerWord {
  char letter = 'R';
  double value = 0.0;
  int column = 0;
  bool has_point = false;
};

/// A line that LinuxCNC's rules accept and that means the same. Every character keeps its column,
/// but those of G28 with axis letters alone.
struct TolerantLine {
  std::string text;
  std::vector<AppliedRule> applied;
  std::optional<CornerWord> corner = {};
};

/// Applies the lexical rules of `reader` to a line.
/// @return the line itself where no rule applies
TolerantLine tolerant_line(std::string_view line, Reader reader);

/// Parses lines as LinuxCNC does and, where it refuses one, as the rules of the reader say.
class LineReader {
 public:
  LineReader(bool block_delete, Reader reader)
      : parser_(block_delete),
        reader_(reader),
        reads_fan_codes_(has_rule(reader, ReaderRule::fan_code)) {}

  void keep_pieces(bool keep) { parser_.keep_pieces(keep); }
  Reader reader() const { return reader_; }

  /// As Parser::parse.
  /// @param line  set to the text that was parsed; it is valid until the next call
  /// @throws InputError as LinuxCNC would put it, if no rule helps
  void parse(std::string_view& line, const std::string& file, int number, Block& block,
             Parser::Extent extent = Parser::Extent::all);

  /// The rules that the line parsed last needed.
  const std::vector<AppliedRule>& applied() const { return tolerant_.applied; }
  /// Its corner, if it has one.
  const std::optional<CornerWord>& corner() const { return tolerant_.corner; }

 private:
  Parser parser_;
  Reader reader_;
  bool reads_fan_codes_;
  TolerantLine tolerant_;
};

}  // namespace servomill::controllers

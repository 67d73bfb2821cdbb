#include "controllers/gcode/parser.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <utility>

#include "controllers/gcode/parser_text.h"
#include "controllers/gcode/program_text.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {
namespace {

constexpr std::string_view kLetters = "ABCDFGHIJKLMPQRSTXYZ@^";

constexpr std::uint32_t kLetterBits = [] {
  std::uint32_t bits = 0;
  for (const char letter : kLetters) bits |= word_bit(letter);
  return bits;
}();

bool starts_word(char c) {
  return (c >= '@' && c <= 'Z' && (kLetterBits & word_bit(c)) != 0) || c == '^';
}

}  // namespace

std::string take_letters(Cursor& cursor) {
  std::string letters;
  for (; is_letter(cursor.peek()); cursor.advance()) letters += cursor.peek();
  return letters;
}

std::string shown(char c) { return c == '\0' ? "the end of the line" : fmt::format("'{}'", c); }

void Parser::fail(std::size_t at, std::string message) const {
  throw InputError({*file_, number_, static_cast<int>(at) + 1}, std::move(message));
}

void Parser::emit(OpCode code, int column, double value, int name) {
  block_->code.push_back({code, name, column, value});
}

// The piece ends where the cursor has come to, blanks before it left out.
void Parser::add_piece(PieceKind kind, std::size_t begin, char letter) {
  if (!keeps_pieces_) return;
  const std::string_view line = cursor_.line();
  std::size_t end = cursor_.at();
  while (end > begin && (line[end - 1] == ' ' || line[end - 1] == '\t')) --end;
  block_->pieces.push_back({kind, letter, static_cast<int>(begin), static_cast<int>(end)});
}

void Parser::parse(std::string_view line, const std::string& file, int number, Block& block,
                   Extent extent) {
  block.clear();
  block.line = number_ = number;
  block_ = &block;
  file_ = &file;
  letters_ = 0;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  cursor_ = Cursor(line);
  check_characters(line, file, number);
  if (block_delete_ && peek() == '/') {
    block.deleted = true;
    cursor_.go_to(line.size());
    add_piece(PieceKind::block_delete, line.find('/'));
    return;
  }
  const std::size_t start = cursor_.at();
  if (accept("%")) {
    if (!cursor_.at_end()) {
      fail(start, "'%' must be alone on its line, first and last in the program");
    }
    block.percent = true;
    return add_piece(PieceKind::percent, start);
  }
  if (accept("/")) add_piece(PieceKind::block_delete, start);
  if (peek() == 'N') line_number();
  flow(extent);
  if (extent != Extent::all) return;
  while (!cursor_.at_end()) item();
}

void Parser::line_number() {
  const std::size_t start = cursor_.at();
  cursor_.advance();
  if (!is_digit(peek())) fail(start, "N must be followed by an unsigned number");
  skip_digits();
  if (accept(".")) {
    if (!is_digit(peek())) fail_here("expected a digit after the decimal point of N");
    skip_digits();
  }
  add_piece(PieceKind::line_number, start);
}

void Parser::skip_digits() {
  while (is_digit(peek())) cursor_.advance();
}

void Parser::item() {
  const char c = peek();
  if (starts_word(c)) return word();
  if (c == '(' || c == ';') return comment();
  if (c == '#') return assignment();
  if (c == 'N') fail_here("N is only allowed at the start of a block");
  if (c == 'O') fail_here("an O-word must be the first word of its block");
  if (c == '%') fail_here("'%' must be alone on its line, first and last in the program");
  if (c == '/')
    fail_here("'/' is only allowed at the start of a block and in [ ]; put remarks in ( )");
  fail_here(fmt::format("unexpected {}; a word starts with one of {}", shown(c), kLetters));
}

void Parser::comment() {
  const std::size_t start = cursor_.at();
  const std::string_view line = cursor_.line();
  if (peek() == ';') {
    cursor_.go_to(line.size());
    block_->pieces.push_back(
        {PieceKind::comment, '\0', static_cast<int>(start), static_cast<int>(line.size())});
    return;
  }
  const std::size_t close = line.find(')', start);
  block_->message = classify_comment(line.substr(start + 1, close - start - 1), column());
  cursor_.go_to(close);
  cursor_.advance();
  add_piece(PieceKind::comment, start);
}

void Parser::word() {
  const std::size_t start = cursor_.at();
  Word word;
  word.letter = peek();
  word.column = column();
  cursor_.advance();
  word.value = value(std::string_view(&word.letter, 1));
  if (word.letter != 'G' && word.letter != 'M') {
    const std::uint32_t bit = word_bit(word.letter);
    if ((letters_ & bit) != 0) {
      const auto first = std::find_if(block_->words.begin(), block_->words.end(),
                                      [&](const Word& w) { return w.letter == word.letter; });
      const char* readings = word.letter == 'T'
                                 ? " (the control determines whether M6 uses the first or the "
                                   "last; program the next tool in a separate block)"
                                 : "";
      fail(start, fmt::format("second {} word in one block; the first is in column {}{}",
                              word.letter, first->column, readings));
    }
    letters_ |= bit;
  }
  block_->words.push_back(word);
  add_piece(PieceKind::word, start, word.letter);
}

void Parser::assignment() {
  const std::size_t start = cursor_.at();
  Assignment assignment;
  assignment.column = column();
  cursor_.advance();
  if (peek() == '<') {
    assignment.name = name_in_angles("parameter name");
  } else {
    assignment.index = value("#");
  }
  if (!accept("="))
    fail_here(fmt::format("expected '=' after a parameter, found {}", shown(peek())));
  assignment.value = value("=");
  block_->assignments.push_back(assignment);
  add_piece(PieceKind::assignment, start);
}

std::string print_line(std::string_view line, const Block& block) {
  std::string out;
  const auto blanks = [&](std::size_t begin, std::size_t end) {
    const std::string_view gap = line.substr(begin, end - begin);
    assert(is_blank(gap));
    out += gap;
  };
  std::size_t at = 0;
  for (const Piece& piece : block.pieces) {
    const auto begin = static_cast<std::size_t>(piece.begin);
    const auto end = static_cast<std::size_t>(piece.end);
    blanks(at, begin);
    out += line.substr(begin, end - begin);
    at = end;
  }
  blanks(at, line.size());
  return out;
}

}  // namespace servomill::controllers

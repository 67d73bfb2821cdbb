#include "sim/compensate/line_pieces.h"

#include <algorithm>

namespace servomill::sim {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
bool is_number(char c) { return (c >= '0' && c <= '9') || c == '.'; }

class Scanner {
 public:
  explicit Scanner(std::string_view line) : line_(line) {}

  std::vector<LinePiece> pieces() {
    while (at_ < line_.size()) piece();
    return std::move(out_);
  }

 private:
  char peek() const { return at_ < line_.size() ? line_[at_] : '\0'; }
  void skip_blanks() {
    while (is_blank(peek())) ++at_;
  }

  void piece() {
    LinePiece one;
    one.begin = at_;
    const char c = peek();
    if (is_blank(c)) {
      skip_blanks();
    } else if (c == '(') {
      one.kind = PieceKind::comment;
      at_ = std::min(line_.find(')', at_), line_.size() - 1) + 1;
    } else if (c == ';') {
      one.kind = PieceKind::comment;
      at_ = line_.size();
    } else if (c == '%') {
      one.kind = PieceKind::percent;
      ++at_;
    } else if (c == '/') {
      one.kind = PieceKind::block_delete;
      ++at_;
    } else if (c == '#') {
      one.kind = PieceKind::assignment;
      is_constant_ = true;
      parameter();
      skip_blanks();
      if (peek() == '=') ++at_;
      is_constant_ = true;  // whatever the index was
      value();
      one.is_constant = is_constant_;
    } else if (is_letter(c)) {
      one.letter = upper(c);
      ++at_;
      one.kind = one.letter == 'N'   ? PieceKind::line_number
                 : one.letter == 'O' ? PieceKind::o_word
                                     : PieceKind::word;
      if (one.kind == PieceKind::o_word) {
        at_ = std::min(line_.find_first_of("(;", at_), line_.size());
      } else {
        is_constant_ = true;
        value();
      }
      one.is_constant = is_constant_;
    } else {
      ++at_;
    }
    one.end = at_;
    out_.push_back(one);
  }

  void bracket() {
    int depth = 0;
    do {
      depth += peek() == '[' ? 1 : peek() == ']' ? -1 : 0;
      ++at_;
    } while (depth > 0 && at_ < line_.size());
  }

  void parameter() {
    is_constant_ = false;
    ++at_;  // '#'
    skip_blanks();
    if (peek() == '<') {
      at_ = std::min(line_.find('>', at_), line_.size() - 1) + 1;
    } else {
      value();
      is_constant_ = false;
    }
  }

  // A number with its blanks, a parameter, a function or an expression in brackets.
  void value() {
    skip_blanks();
    if (peek() == '+' || peek() == '-') {
      ++at_;
      skip_blanks();
    }
    if (peek() == '#') return parameter();
    if (peek() == '+' || peek() == '-') return value();
    if (is_letter(peek())) {
      is_constant_ = false;
      at_ = std::min(line_.find('[', at_), line_.size());
      bracket();
      const std::size_t behind = at_;
      skip_blanks();
      if (peek() != '/') {
        at_ = behind;
        return;
      }
      ++at_;  // ATAN[]/[]
      skip_blanks();
      return bracket();
    }
    if (peek() == '[') {
      is_constant_ = false;
      return bracket();
    }
    std::size_t end = at_;
    while (at_ < line_.size() && (is_number(peek()) || is_blank(peek()))) {
      if (is_number(peek())) end = at_ + 1;
      ++at_;
    }
    at_ = end;
  }

  std::string_view line_;
  std::size_t at_ = 0;
  bool is_constant_ = true;
  std::vector<LinePiece> out_;
};

}  // namespace

std::vector<LinePiece> line_pieces(std::string_view line) { return Scanner(line).pieces(); }

}  // namespace servomill::sim

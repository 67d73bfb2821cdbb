#include "controllers/siemens/scanner.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace servomill::controllers::siemens {
namespace {

constexpr double kLargestNumber = 1e12;  // beyond any machine, so that squares stay finite

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

std::string shown(char c) {
  const auto code = static_cast<unsigned char>(c);
  return code > ' ' && code < 127 ? fmt::format("'{}'", c) : fmt::format("byte {:#04x}", code);
}

// The block up to its comment; a ';' in quotes is a part of the text.
std::string_view without_comment(std::string_view line) {
  bool is_quoted = false;
  for (std::size_t at = 0; at < line.size(); ++at) {
    if (line[at] == '"') is_quoted = !is_quoted;
    if (line[at] == ';' && !is_quoted) return line.substr(0, at);
  }
  const std::size_t comment = line.find(';');
  return is_quoted && comment != line.npos ? line.substr(0, comment) : line;
}

}  // namespace

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return upper(c) >= 'A' && upper(c) <= 'Z'; }
bool is_name_character(char c) { return is_letter(c) || is_digit(c) || c == '_'; }

std::string capitals(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = upper(c);
  return out;
}

Scanner::Scanner(std::string_view line, const std::string& file, int number, std::size_t column)
    : line_(without_comment(line)), file_(file), number_(number), column_(column) {}

Place Scanner::place(std::size_t at) const {
  return {file_, number_, static_cast<int>(column_ + at) + 1};
}
Place Scanner::place() const { return place(at_); }
void Scanner::fail(std::string message) const { throw InputError(place(), std::move(message)); }

void Scanner::skip_blanks() {
  while (at_ < line_.size() && is_blank(line_[at_])) ++at_;
}

bool Scanner::at_end() {
  skip_blanks();
  return at_ == line_.size();
}

bool Scanner::take(char c) {
  skip_blanks();
  if (now() != c) return false;
  ++at_;
  return true;
}

bool Scanner::take_sign(std::string_view sign) {
  skip_blanks();
  if (!rest().starts_with(sign)) return false;
  at_ += sign.size();
  return true;
}

std::string Scanner::peek_name() {
  skip_blanks();
  std::size_t end = at_;
  if (end < line_.size() && line_[end] == '$') ++end;
  if (end == line_.size() || is_digit(line_[end])) return {};
  while (end < line_.size() && is_name_character(line_[end])) ++end;
  return capitals(line_.substr(at_, end - at_));
}

std::string Scanner::read_name() {
  std::string name = peek_name();
  at_ += name.size();
  return name;
}

bool Scanner::take_word(std::string_view name) {
  if (peek_name() != name) return false;
  at_ += name.size();
  return true;
}

void Scanner::expect(char c, std::string_view behind) {
  if (!take(c)) fail(fmt::format("'{}' is missing after {}", c, behind));
}

bool Scanner::is_at_number() {
  skip_blanks();
  return is_digit(now()) || (now() == '.' && is_digit(ahead(1))) || now() == '\'';
}

// 'H1F' and 'B101': Fundamentals, "Constants".
double Scanner::read_constant() {
  const std::size_t begin = at_;
  const std::size_t close = line_.find('\'', at_ + 1);
  const char kind = upper(ahead(1));
  if (close == line_.npos || (kind != 'H' && kind != 'B')) fail("expected 'H...' or 'B...'");
  const std::string_view digits = line_.substr(begin + 2, close - begin - 2);
  unsigned value = 0;
  const auto [end, error] =
      std::from_chars(digits.data(), digits.data() + digits.size(), value, kind == 'H' ? 16 : 2);
  if (error != std::errc() || end != digits.data() + digits.size()) {
    fail(fmt::format("'{}' is not a constant", digits));
  }
  at_ = close + 1;
  return value;
}

double Scanner::read_number() {
  skip_blanks();
  if (now() == '\'') return read_constant();
  const std::size_t begin = at_;
  bool has_digit = false, has_point = false;
  for (; is_digit(now()) || (now() == '.' && !has_point); ++at_) {
    has_digit = has_digit || is_digit(now());
    has_point = has_point || now() == '.';
  }
  if (!has_digit) {
    at_ = begin;
    fail(now() == '\0' ? "a number is missing at the end of the block"
                       : fmt::format("expected a number, not {}", shown(now())));
  }
  std::string text(line_.substr(begin, at_ - begin));
  const bool has_exponent = upper(now()) == 'E' && upper(ahead(1)) == 'X' &&
                            (is_digit(ahead(2)) || ahead(2) == '-' || ahead(2) == '+');
  if (has_exponent) {
    at_ += 2;
    text += 'e';
    if (now() == '-') text += '-';
    if (now() == '-' || now() == '+') ++at_;
    while (is_digit(now())) text += line_[at_++];
  }
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value <= kLargestNumber)) {
    at_ = begin;
    fail(fmt::format("'{}' is not a valid number", text));
  }
  return value;
}

std::string Scanner::read_text() {
  skip_blanks();
  const std::size_t close = line_.find('"', at_ + 1);
  if (now() != '"' || close == line_.npos) fail("the text has no closing quote");
  std::string text(line_.substr(at_ + 1, close - at_ - 1));
  at_ = close + 1;
  return text;
}

std::string Scanner::read_brackets() {
  if (now() != '[') return {};
  const std::size_t begin = at_;
  int depth = 0;
  std::string text;
  for (; at_ < line_.size(); ++at_) {
    const char c = line_[at_];
    if (!is_blank(c)) text += upper(c);
    if (c == '[') ++depth;
    if (c == ']' && --depth == 0) {
      ++at_;
      return text;
    }
  }
  at_ = begin;
  fail("the bracket is not closed");
}

std::string_view Scanner::read_to_parenthesis() {
  const std::size_t begin = at_;
  bool is_quoted = false;
  int depth = 1;
  for (; at_ < line_.size(); ++at_) {
    const char c = line_[at_];
    if (c == '"') is_quoted = !is_quoted;
    if (is_quoted) continue;
    if (c == '(') ++depth;
    if (c == ')' && --depth == 0) {
      ++at_;
      return line_.substr(begin, at_ - begin - 1);
    }
  }
  at_ = begin;
  fail("the parenthesis is not closed");
}

}  // namespace servomill::controllers::siemens

#include "controllers/gcode/macro/line.h"

#include <algorithm>
#include <array>
#include <utility>

#include "controllers/gcode/lexer.h"

namespace servomill::controllers::macro {
namespace {

char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

// End of the comment that opens at `open`, behind the ')' that closes it.
std::size_t comment_end(std::string_view text, std::size_t open) {
  int depth = 0;
  for (std::size_t i = open; i < text.size(); ++i) {
    if (text[i] == '(') ++depth;
    if (text[i] == ')' && --depth == 0) return i + 1;
  }
  const std::size_t first = text.find(')', open);
  return first == std::string_view::npos ? text.size() : first + 1;
}

void blank(std::string& body, std::size_t begin, std::size_t end) {
  std::fill(body.begin() + static_cast<std::ptrdiff_t>(begin),
            body.begin() + static_cast<std::ptrdiff_t>(end), ' ');
}

void blank_comments(std::string_view text, Line& line) {
  for (std::size_t at = 0; at < line.body.size(); ++at) {
    if (line.body[at] == ';') return line.body.resize(at);
    if (line.body[at] != '(') continue;
    const std::size_t end = comment_end(text, at);
    if (line.comment.empty() && end > at + 1) {
      line.comment = text.substr(at + 1, end - at - (text[end - 1] == ')' ? 2 : 1));
    }
    blank(line.body, at, end);
  }
}

void skip_blanks(const std::string& body, std::size_t& at) {
  while (at < body.size() && is_blank(body[at])) ++at;
}

void take_block_skip(Line& line) {
  skip_blanks(line.body, line.begin);
  if (line.begin >= line.body.size() || line.body[line.begin] != '/') return;
  line.is_optional = true;
  const std::size_t from = line.begin++;
  if (line.begin < line.body.size() && is_digit(line.body[line.begin])) ++line.begin;
  blank(line.body, from, line.begin);
  skip_blanks(line.body, line.begin);
}

void take_block_number(Line& line) {
  constexpr long kMax = 99'999'999;
  std::size_t at = line.begin;
  if (at >= line.body.size() || upper(line.body[at]) != 'N') return;
  for (++at; at < line.body.size() && is_blank(line.body[at]);) ++at;
  if (at >= line.body.size() || !is_digit(line.body[at])) return;
  long number = 0;
  for (; at < line.body.size() && is_digit(line.body[at]) && number <= kMax; ++at) {
    number = number * 10 + (line.body[at] - '0');
  }
  if (at < line.body.size() && line.body[at] == '.') return;
  line.block_number = number;
  blank(line.body, line.begin, at);
  line.begin = at;
  skip_blanks(line.body, line.begin);
}

// Looks at the first word only, behind '/' and N: most lines begin with another.
bool may_be_macro(std::string_view text) {
  std::size_t at = 0;
  const auto skip = [&](std::string_view characters) {
    while (at < text.size() && characters.find(text[at]) != std::string_view::npos) ++at;
  };
  skip("/ \t");
  if (at < text.size() && upper(text[at]) == 'N') {
    ++at;
    while (at < text.size() && (is_digit(text[at]) || is_blank(text[at]))) ++at;
  }
  if (at + 1 >= text.size()) return false;
  const char next = upper(text[at + 1]);
  switch (upper(text[at])) {
    case 'I':
    case 'W':
    case 'P':
    case 'D':
    case 'B':
    case '#':
      return true;
    case 'G':
      return next == 'O' || next == '6';
    case 'M':
      return next == '9';
    default:
      return is_digit(text[at]);  // /2
  }
}

Cursor cursor_at(std::string_view body, std::size_t at) {
  Cursor cursor(body);
  cursor.go_to(at);
  return cursor;
}

// #1=#2+1, #3=#1 MOD 3: an operator behind a value, outside of brackets. LinuxCNC reads what stands
// there as the next word.
bool has_open_operator(std::string_view body) {
  constexpr std::string_view kSigns = "+-*/";
  constexpr std::array<std::string_view, 4> kNames = {"MOD", "AND", "OR", "XOR"};
  if (body.find('<') != std::string_view::npos) return false;  // #<name-2>
  int depth = 0;
  char before = '=';
  for (std::size_t i = 0; i < body.size(); ++i) {
    const char c = upper(body[i]);
    if (is_blank(c)) continue;
    const bool is_behind_value = is_digit(before) || before == '.' || before == ']';
    if (depth == 0 && is_behind_value) {
      if (kSigns.find(c) != std::string_view::npos) return true;
      if (std::any_of(kNames.begin(), kNames.end(), [&](std::string_view name) {
            Cursor cursor = cursor_at(body, i);
            return cursor.accept(name);
          })) {
        return true;
      }
    }
    depth += c == '[' ? 1 : c == ']' ? -1 : 0;
    before = c;
  }
  return false;
}

bool has_code(std::string_view body, char letter, std::string_view digits) {
  for (std::size_t i = 0; i < body.size(); ++i) {
    if (upper(body[i]) != letter) continue;
    Cursor cursor = cursor_at(body, i);
    cursor.advance();
    while (cursor.peek() == '0') cursor.advance();
    if (cursor.accept(digits) && !is_digit(cursor.peek())) return true;
  }
  return false;
}

}  // namespace

Statement statement_at(std::string_view body, std::size_t at) {
  if (at >= body.size()) return Statement::blank;
  Cursor cursor = cursor_at(body, at);
  const auto begins = [&](std::string_view word, std::string_view next) {
    Cursor c = cursor;
    if (!c.accept(word)) return false;
    return next.empty() || next.find(c.peek()) != std::string_view::npos;
  };
  constexpr std::string_view kDigits = "0123456789#[";
  switch (cursor.peek()) {
    case '#':
      return Statement::assignment;
    case '%':
      return Statement::percent;
    case '[':
      return Statement::conditional_return;
    case ':':
      return begins(":", "0123456789") ? Statement::program_number : Statement::words;
    case 'O':
      return begins("O", "0123456789") ? Statement::program_number : Statement::words;
    case 'I':
      return begins("IF", "[") ? Statement::if_ : Statement::words;
    case 'W':
      return begins("WHILE", "[") ? Statement::while_ : Statement::words;
    case 'G':
      return begins("GOTO", kDigits) ? Statement::go_to : Statement::words;
    case 'E':
      return begins("END", "0123456789") ? Statement::end : Statement::words;
    case 'D':
      if (begins("DPRNT", "[")) return Statement::output;
      return begins("DO", "0123456789") ? Statement::do_ : Statement::words;
    case 'B':
      return begins("BPRNT", "[") ? Statement::output : Statement::words;
    case 'P':
      return begins("POPEN", "") || begins("PCLOS", "") ? Statement::output : Statement::words;
    default:
      return Statement::words;
  }
}

void read_line(std::string_view text, Line& line) {
  line.body.assign(text);
  line.begin = 0;
  line.block_number = -1;
  line.is_optional = false;
  line.comment.clear();
  if (text.find_first_of("(;") != std::string_view::npos) blank_comments(text, line);
  while (!line.body.empty() && is_blank(line.body.back())) line.body.pop_back();
  take_block_skip(line);
  take_block_number(line);
  line.statement = statement_at(line.body, line.begin);
}

bool is_macro_only(std::string_view text, Line& line) {
  if (!may_be_macro(text)) return false;
  read_line(text, line);
  switch (line.statement) {
    case Statement::if_:
    case Statement::while_:
    case Statement::go_to:
    case Statement::output:
      return true;
    case Statement::assignment:
      return has_open_operator(line.body);
    case Statement::words:
      return has_code(line.body, 'G', "65") || has_code(line.body, 'G', "66") ||
             (has_code(line.body, 'M', "99") && line.body.find_first_of("Pp") != std::string::npos);
    default:
      return false;
  }
}

bool has_call_code(std::string_view body) {
  constexpr std::array<std::pair<char, std::string_view>, 6> kCodes = {
      {{'M', "97"}, {'M', "98"}, {'M', "99"}, {'G', "65"}, {'G', "66"}, {'G', "67"}}};
  return std::any_of(kCodes.begin(), kCodes.end(),
                     [&](const auto& one) { return has_code(body, one.first, one.second); });
}

}  // namespace servomill::controllers::macro

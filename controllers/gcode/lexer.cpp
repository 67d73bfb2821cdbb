#include "controllers/gcode/lexer.h"

#include <fmt/format.h>

#include <array>
#include <cctype>
#include <utility>

#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t'; }

char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

constexpr std::array<std::pair<std::string_view, CommentKind>, 3> kActiveComments = {{
    {"MSG,", CommentKind::message},
    {"DEBUG,", CommentKind::debug},
    {"PRINT,", CommentKind::print},
}};

// If `text` starts with `keyword` (blanks and case aside), where the rest starts; else npos.
std::size_t behind_keyword(std::string_view text, std::string_view keyword) {
  std::size_t i = 0;
  for (const char k : keyword) {
    while (i < text.size() && is_blank(text[i])) ++i;
    if (i == text.size() || upper(text[i]) != k) return std::string_view::npos;
    ++i;
  }
  return i;
}

Comment classify(std::string_view text, int column) {
  for (const auto& [keyword, kind] : kActiveComments) {
    const std::size_t rest = behind_keyword(text, keyword);
    if (rest != std::string_view::npos) return {kind, std::string(text.substr(rest)), column};
  }
  return {CommentKind::plain, {}, column};
}

std::string shown(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte >= 0x20 && byte < 0x7f ? fmt::format("'{}'", c) : fmt::format("byte 0x{:02X}", byte);
}

}  // namespace

void read_line(std::string_view line, const std::string& file, int number, CodeLine& out) {
  out.comments.clear();
  const auto fail = [&](std::size_t at, std::string message) {
    throw InputError({file, number, static_cast<int>(at) + 1}, std::move(message));
  };
  if (line.size() > kLongestLine) {
    fail(kLongestLine,
         fmt::format("line of {} characters; at most {} are allowed", line.size(), kLongestLine));
  }
  out.text.resize(line.size());
  out.column.resize(line.size() + 1);
  std::size_t i = 0, length = 0;
  const auto put = [&](char c) {
    out.text[length] = c;
    out.column[length++] = static_cast<int>(i) + 1;
  };
  for (; i < line.size(); ++i) {
    const char c = line[i];
    if (is_blank(c)) continue;
    if (c == ';') break;
    if (c == '(') {
      const std::size_t close = line.find_first_of("()", i + 1);
      if (close == std::string_view::npos) fail(i, "comment is not closed; ')' is missing");
      if (line[close] == '(') fail(close, "comment within a comment");
      out.comments.push_back(classify(line.substr(i + 1, close - i - 1), static_cast<int>(i) + 1));
      put('(');
      i = close;
      continue;
    }
    if (c == ')') fail(i, "')' without '('");
    if (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f) {
      fail(i, fmt::format("{} is not allowed outside comments", shown(c)));
    }
    put(upper(c));
  }
  out.text.resize(length);
  out.column.resize(length + 1);
  out.column[length] = static_cast<int>(i) + 1;
}

}  // namespace servomill::controllers

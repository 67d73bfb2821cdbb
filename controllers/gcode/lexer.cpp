#include "controllers/gcode/lexer.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {
namespace {

constexpr std::array<std::pair<std::string_view, CommentKind>, 3> kActiveComments = {{
    {"MSG,", CommentKind::message},
    {"DEBUG,", CommentKind::debug},
    {"PRINT,", CommentKind::print},
}};

enum class Class : std::uint8_t { plain, blank, open, close, semicolon, forbidden };

constexpr std::array<Class, 256> kClasses = [] {
  std::array<Class, 256> classes{};
  for (std::size_t i = 0; i < classes.size(); ++i) {
    classes[i] = i < 0x20 || i >= 0x7f ? Class::forbidden : Class::plain;
  }
  classes[' '] = classes['\t'] = Class::blank;
  classes['('] = Class::open;
  classes[')'] = Class::close;
  classes[';'] = Class::semicolon;
  return classes;
}();

char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

std::string shown(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte >= 0x20 && byte < 0x7f ? fmt::format("'{}'", c) : fmt::format("byte 0x{:02X}", byte);
}

}  // namespace

Comment classify_comment(std::string_view text, int column) {
  for (const auto& [keyword, kind] : kActiveComments) {
    const bool is_it =
        text.size() >= keyword.size() && std::equal(keyword.begin(), keyword.end(), text.begin(),
                                                    [](char k, char c) { return k == upper(c); });
    if (is_it) return {kind, std::string(text.substr(keyword.size())), column};
  }
  return {CommentKind::plain, {}, column};
}

void check_characters(std::string_view line, const std::string& file, int number) {
  const auto fail = [&](std::size_t at, std::string message) {
    throw InputError({file, number, static_cast<int>(at) + 1}, std::move(message));
  };
  if (line.size() > kLongestLine) {
    fail(kLongestLine,
         fmt::format("line of {} characters; at most {} are allowed", line.size(), kLongestLine));
  }
  for (std::size_t i = 0; i < line.size(); ++i) {
    switch (kClasses[static_cast<unsigned char>(line[i])]) {
      case Class::plain:
      case Class::blank:
        break;
      case Class::semicolon:
        return;
      case Class::open: {
        const std::size_t close = line.find_first_of("()", i + 1);
        if (close == std::string_view::npos) fail(i, "comment is not closed; ')' is missing");
        if (line[close] == '(') fail(close, "comment within a comment");
        i = close;
        break;
      }
      case Class::close:
        fail(i, "')' without '('");
        break;
      case Class::forbidden:
        fail(i, fmt::format("{} is not allowed outside comments", shown(line[i])));
    }
  }
}

}  // namespace servomill::controllers

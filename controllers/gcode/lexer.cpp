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

// Classes of a character, as bits, so that a harmless line is seen in one pass.
constexpr std::uint8_t kPlain = 0, kSemicolon = 1, kOpen = 2, kClose = 4, kForbidden = 8;

constexpr std::array<std::uint8_t, 256> kClasses = [] {
  std::array<std::uint8_t, 256> classes{};
  for (std::size_t i = 0; i < classes.size(); ++i) {
    classes[i] = i < 0x20 || i >= 0x7f ? kForbidden : kPlain;
  }
  classes['\t'] = kPlain;
  classes['('] = kOpen;
  classes[')'] = kClose;
  classes[';'] = kSemicolon;
  return classes;
}();

std::uint8_t class_of(char c) { return kClasses[static_cast<unsigned char>(c)]; }

char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

bool is_of_utf_16(char first) { return first == '\xFF' || first == '\xFE'; }

std::string shown(char c) {
  const auto byte = static_cast<unsigned char>(c);
  return byte >= 0x20 && byte < 0x7f ? fmt::format("'{}'", c) : fmt::format("byte 0x{:02X}", byte);
}

}  // namespace

Comment classify_comment(std::string_view text, int column) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
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
  std::uint8_t found = kPlain;
  for (const char c : line) found |= class_of(c);
  if (found == kPlain) return;
  for (std::size_t i = 0; i < line.size(); ++i) {
    switch (class_of(line[i])) {
      case kSemicolon:
        return;
      case kOpen: {
        const std::size_t close = line.find_first_of("()", i + 1);
        if (close == std::string_view::npos) fail(i, "comment is not closed; ')' is missing");
        if (line[close] == '(') fail(close, "comment within a comment");
        i = close;
        break;
      }
      case kClose:
        fail(i, "')' without '('");
        break;
      case kForbidden:
        fail(i, fmt::format("{} is not allowed outside comments{}", shown(line[i]),
                            number == 1 && i == 0 && is_of_utf_16(line[i])
                                ? "; the file looks like UTF-16: save it as UTF-8"
                                : ""));
        break;
      default:
        break;
    }
  }
}

}  // namespace servomill::controllers

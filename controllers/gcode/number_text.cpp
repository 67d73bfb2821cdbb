#include "controllers/gcode/number_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "controllers/gcode/lexer.h"

namespace servomill::controllers {
namespace {

constexpr int kSignificant = 12;           // digits
constexpr std::size_t kLongestText = 200;  // of a message; a line holds at most 252 characters

std::string trim_zeros(std::string text) {
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text == "-0" ? "0" : text;
}

}  // namespace

std::string fixed_text(double x, int decimals) {
  return trim_zeros(fmt::format("{:.{}f}", x, decimals));
}

std::string significant_text(double x) {
  const int magnitude = x == 0.0 ? 0 : static_cast<int>(std::floor(std::log10(std::abs(x))));
  return fixed_text(x, std::clamp(kSignificant - 1 - magnitude, 0, 30));
}

std::string dwell_block(double seconds) {
  const std::string text = significant_text(seconds);
  return fmt::format("G4 P{}{}", text, text.find('.') == std::string::npos ? "." : "");
}

std::string comment_text(std::string_view text) {
  std::string out;
  for (const char c : text.substr(0, kLongestText)) {
    out += c == '(' ? '[' : c == ')' ? ']' : c == '\n' || c == '\r' ? ' ' : c;
  }
  return out;
}

std::string remark(std::string_view text) {
  const std::string inside = comment_text(text);
  const bool speaks = classify_comment(inside, 0).kind != CommentKind::plain;
  return fmt::format("({}{})", speaks ? "- " : "", inside);
}

}  // namespace servomill::controllers

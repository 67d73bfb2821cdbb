#include "controllers/gcode/number_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>

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

// Multiples of 10^-decimals nearest to |x|; nullopt where a product of doubles does not tell.
std::optional<std::uint64_t> rounded_steps(double x, int decimals) {
  constexpr std::array kPowers = {1e0, 1e1, 1e2, 1e3,  1e4,  1e5, 1e6,
                                  1e7, 1e8, 1e9, 1e10, 1e11, 1e12};
  constexpr double kLargest = 1e13;  // of which a double has a last bit of 0.002
  constexpr double kNearHalf = 0.01;
  const auto power = static_cast<std::size_t>(decimals);
  if (decimals < 0 || power >= kPowers.size()) return std::nullopt;
  const double steps = std::abs(x) * kPowers[power];
  if (!(steps < kLargest)) return std::nullopt;
  const double whole = std::floor(steps), rest = steps - whole;
  if (std::abs(rest - 0.5) < kNearHalf) return std::nullopt;
  return static_cast<std::uint64_t>(whole) + (rest > 0.5 ? 1 : 0);
}

// Without the zeros behind the last digit.
std::string text_of_steps(std::uint64_t steps, int decimals, bool is_negative) {
  while (decimals > 0 && steps % 10 == 0) {
    steps /= 10;
    --decimals;
  }
  if (steps == 0) return "0";
  std::array<char, 32> text;
  auto begin = text.end();
  for (int place = 0; steps > 0 || place <= decimals; ++place) {
    if (place == decimals && place > 0) *--begin = '.';
    *--begin = static_cast<char>('0' + steps % 10);
    steps /= 10;
  }
  if (is_negative) *--begin = '-';
  return {begin, text.end()};
}

}  // namespace

std::string fixed_text(double x, int decimals) {
  if (const auto steps = rounded_steps(x, decimals)) {
    return text_of_steps(*steps, decimals, std::signbit(x));
  }
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

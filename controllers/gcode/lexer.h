/// First stage of reading a program: the characters of a line that count, and its comments.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "controllers/gcode/block.h"

namespace servomill::controllers {

/// Longest line that is accepted, counted in characters without the line end, as LinuxCNC's
/// stand-alone interpreter has it.
inline constexpr std::size_t kLongestLine = 252;

/// Goes through a line as RS274/NGC reads it: blanks do not count (also within numbers), capitals
/// and small letters are the same. Stands on a character that counts, or at the end.
class Cursor {
 public:
  Cursor() = default;
  explicit Cursor(std::string_view line) : line_(line) { skip_blanks(); }

  /// In upper case; '\0' at the end.
  char peek() const { return at_ < line_.size() ? kUpper[byte(at_)] : '\0'; }
  bool at_end() const { return at_ >= line_.size(); }
  void advance() {
    ++at_;
    skip_blanks();
  }
  /// Passes a token in upper case if it stands here.
  bool accept(std::string_view token) {
    const std::size_t start = at_;
    for (const char c : token) {
      if (peek() != c) {
        at_ = start;
        return false;
      }
      advance();
    }
    return true;
  }
  /// Passes digits and appends them to a number, modulo 2^64. Returns how many.
  int take_digits(std::uint64_t& number) {
    int count = 0;
    for (;;) {
      for (; at_ < line_.size(); ++at_, ++count) {
        const auto digit = static_cast<unsigned char>(line_[at_] - '0');
        if (digit > 9) break;
        number = number * 10 + digit;
      }
      if (at_ == line_.size() || !is_blank(line_[at_])) return count;
      skip_blanks();
    }
  }
  std::size_t at() const { return at_; }
  void go_to(std::size_t at) { at_ = at; }
  int column() const { return static_cast<int>(at_) + 1; }
  std::string_view line() const { return line_; }

 private:
  static constexpr std::array<char, 256> kUpper = [] {
    std::array<char, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) {
      const bool is_small = i >= 'a' && i <= 'z';
      table[i] = static_cast<char>(is_small ? i - 'a' + 'A' : i);
    }
    return table;
  }();

  std::size_t byte(std::size_t i) const { return static_cast<unsigned char>(line_[i]); }
  static bool is_blank(char c) { return c == ' ' || c == '\t'; }
  void skip_blanks() {
    while (at_ < line_.size() && is_blank(line_[at_])) ++at_;
  }

  std::string_view line_;
  std::size_t at_ = 0;
};

/// Kind of the text between '(' and ')': a message if it begins with MSG, DEBUG, or PRINT, and a
/// comma, in capitals or not, without blanks within. A comment behind ';' is always a plain one.
/// @param column  of the '('
Comment classify_comment(std::string_view text, int column);

/// Refuses what makes a line unreadable, whatever it says: its length, comments that are not
/// closed or stand in each other, a stray ')', characters that only comments may hold.
/// @throws InputError
void check_characters(std::string_view line, const std::string& file, int number);

}  // namespace servomill::controllers

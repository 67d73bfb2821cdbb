/// Blocks of a Fanuc program as words.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace servomill::controllers {

/// A letter with its number, digits kept: mantissa / 10^decimals.
struct FanucWord {
  char letter = '\0';
  std::int64_t mantissa = 0;
  int decimals = 0;
  bool has_point = false;
  int column = 0;

  double value() const;
  bool is_integer() const { return !has_point; }
};

struct FanucBlock {
  int line = 0;
  bool has_slash = false;
  std::vector<FanucWord> words;  // N and O left out
  const FanucWord* find(char letter) const;
};

/// Splits a program into blocks: comments, N, O and % are checked and left out.
class FanucLexer {
 public:
  FanucLexer(std::string_view text, const std::string& file) : text_(text), file_(file) {}

  /// The next block with words, or nullopt at the end (the second %, or the end of the text).
  /// @throws InputError with line and column
  std::optional<FanucBlock> next();

 private:
  std::optional<std::string_view> next_line();
  bool take_percent(std::string_view line);
  FanucBlock split(std::string_view line);
  FanucWord word(std::string_view line, std::size_t& i) const;
  void keep(FanucBlock& block, const FanucWord& word);
  [[noreturn]] void fail(std::size_t i, const std::string& message) const;

  std::string_view text_;
  const std::string& file_;
  std::size_t at_ = 0;
  int line_ = 0;
  int percents_ = 0;
  bool has_name_ = false, has_begun_ = false;
};

}  // namespace servomill::controllers

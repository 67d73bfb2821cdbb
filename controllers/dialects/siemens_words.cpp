#include "controllers/dialects/siemens_words.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <utility>

#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {
namespace {

constexpr std::size_t kLongestLine = 512;  // characters (M)
constexpr std::size_t kLongestBlockNumber = 9;
constexpr double kLargestNumber = 1e9;  // beyond any machine, so that squares stay finite

bool is_blank(char c) { return c == ' ' || c == '\t'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; }
char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

std::string shown(char c) {
  const auto code = static_cast<unsigned char>(c);
  return code > ' ' && code < 127 ? fmt::format("'{}'", c) : fmt::format("byte {:#04x}", code);
}

class LineReader {
 public:
  LineReader(std::string_view line, int number, const std::string& file)
      : line_(line), number_(number), file_(file) {}

  SiemensLine read() {
    if (line_.size() > kLongestLine) {
      fail(kLongestLine, fmt::format("the line has {} characters; a block has at most {}",
                                     line_.size(), kLongestLine));
    }
    SiemensLine out;
    skip_blanks();
    read_slash(out);
    read_block_number();
    for (skip_blanks(); !at_end() && now() != ';'; skip_blanks()) out.words.push_back(read_word());
    out.is_empty = out.words.empty();
    return out;
  }

 private:
  bool at_end() const { return at_ == line_.size(); }
  char now() const { return line_[at_]; }
  bool is_now(char c) const { return !at_end() && now() == c; }
  void skip_blanks() {
    while (!at_end() && is_blank(now())) ++at_;
  }
  [[noreturn]] void fail(std::size_t at, std::string message) const {
    throw InputError(Place{file_, number_, static_cast<int>(at) + 1}, std::move(message));
  }

  // '/' and '/0' are the first skip level; the others have switches of their own (M).
  void read_slash(SiemensLine& out) {
    if (!is_now('/')) return;
    const std::size_t at = at_++;
    out.is_skippable = true;
    if (at_end() || !is_digit(now())) return;
    if (now() != '0') {
      fail(at, fmt::format("/{}: skip level {} has its own switch; only that of / is supported",
                           now(), now()));
    }
    ++at_;
    if (!at_end() && is_digit(now())) fail(at, "skip levels are /0 ... /9");
  }

  void read_block_number() {
    skip_blanks();
    if (at_end() || upper(now()) != 'N' || at_ + 1 == line_.size() || !is_digit(line_[at_ + 1])) {
      return;
    }
    const std::size_t begin = ++at_;
    while (!at_end() && is_digit(now())) ++at_;
    if (at_ - begin > kLongestBlockNumber) {
      fail(begin, fmt::format("block number with {} digits; at most {}", at_ - begin,
                              kLongestBlockNumber));
    }
  }

  // "I1=AC(5)": the point that CIP goes through. With other letters the digit is an extension.
  bool is_at_through_address() const {
    if (std::string_view("IJK").find(upper(now())) == std::string_view::npos) return false;
    if (at_ + 1 == line_.size() || line_[at_ + 1] != '1') return false;
    const std::size_t after = line_.find_first_not_of(" \t", at_ + 2);
    return after != std::string_view::npos && line_[after] == '=';
  }

  std::string read_name() {
    std::string name;
    if (is_at_through_address()) {
      name = {upper(now()), '1'};
      at_ += 2;
    } else if (at_ + 1 < line_.size() && is_letter(line_[at_ + 1])) {
      while (!at_end() && (is_letter(now()) || is_digit(now()))) name += upper(line_[at_++]);
    } else {
      name = upper(line_[at_++]);
    }
    return name;
  }

  SiemensWord read_word() {
    SiemensWord word;
    const std::size_t begin = at_;
    word.column = static_cast<int>(begin) + 1;
    if (!is_letter(now())) fail(at_, fmt::format("{} does not start a word", shown(now())));
    word.name = read_name();
    const bool is_address = word.name.size() == 1;
    if (word.name == "F") skip_blanks();  // "F 100" [P] p. 108
    const std::size_t after = at_;
    skip_blanks();
    if (is_now('=')) {
      ++at_;
      read_value(word);
    } else if (!is_address && is_now('(')) {
      word.form = SiemensForm::call;
      word.text = read_parentheses();
    } else if (at_ = after; is_address) {
      word.form = SiemensForm::number;
      word.value = read_number(word.name);
      refuse_extension(word, begin);
    } else if (is_now(':')) {
      fail(begin, fmt::format("{}: labels and jumps are not supported", word.name));
    }
    return word;
  }

  // "S2=1000": the number is a spindle or an axis, not a value.
  void refuse_extension(const SiemensWord& word, std::size_t begin) {
    const std::size_t after = at_;
    skip_blanks();
    if (is_now('=')) {
      fail(begin, fmt::format("{}=: extended addresses are not supported",
                              line_.substr(begin, after - begin)));
    }
    at_ = after;
    if (word.name == "N") fail(begin, "N is the block number and must start the block");
  }

  void read_value(SiemensWord& word) {
    skip_blanks();
    if (is_now('"')) {
      const std::size_t close = line_.find('"', at_ + 1);
      if (close == std::string_view::npos) fail(at_, "the string is not closed; '\"' is missing");
      word.form = SiemensForm::text;
      word.text = line_.substr(at_ + 1, close - at_ - 1);
      at_ = close + 1;
      return;
    }
    if (!at_end() && is_letter(now())) return read_dimension(word);
    word.form = SiemensForm::number;
    word.value = read_number(word.name);
    skip_blanks();
    if (!at_end() && std::string_view("+-*/").find(now()) != std::string_view::npos) {
      fail(at_, fmt::format("{}=: expressions are not supported", word.name));
    }
  }

  // AC(...) and IC(...) hold one plain number.
  void read_dimension(SiemensWord& word) {
    const std::size_t begin = at_;
    std::string name;
    while (!at_end() && (is_letter(now()) || is_digit(now()))) name += upper(line_[at_++]);
    if (name != "AC" && name != "IC") {
      fail(begin,
           fmt::format("{}={}: only numbers, AC(...) and IC(...) are supported", word.name, name));
    }
    skip_blanks();
    if (!is_now('(')) fail(at_, fmt::format("{} requires a number in parentheses", name));
    ++at_;
    skip_blanks();
    word.form = name == "AC" ? SiemensForm::absolute : SiemensForm::incremental;
    word.value = read_number(name);
    skip_blanks();
    if (!is_now(')')) fail(at_, fmt::format("{}(...) must contain one number", name));
    ++at_;
  }

  double read_number(std::string_view name) {
    const std::size_t begin = at_;
    const bool has_plus = is_now('+');
    if (has_plus || is_now('-')) ++at_;
    bool has_digit = false;
    for (bool has_point = false; !at_end() && (is_digit(now()) || (now() == '.' && !has_point));
         ++at_) {
      has_digit = has_digit || is_digit(now());
      has_point = has_point || now() == '.';
    }
    if (!has_digit) fail(begin, fmt::format("{} requires a number", name));
    double value = 0.0;
    const char* first = line_.data() + begin + (has_plus ? 1 : 0);
    const auto result = std::from_chars(first, line_.data() + at_, value);
    if (result.ec != std::errc() || !std::isfinite(value)) {
      fail(begin, fmt::format("{}: the number is too long", name));
    }
    if (std::abs(value) > kLargestNumber) {
      fail(begin, fmt::format("{} = {}; must be between -1e9 and 1e9", name, value));
    }
    return value;
  }

  // Up to the parenthesis that closes; quoted texts may hold some.
  std::string read_parentheses() {
    const std::size_t begin = at_++;
    bool is_quoted = false;
    for (; !at_end() && (is_quoted || now() != ')'); ++at_) {
      if (now() == '"') is_quoted = !is_quoted;
    }
    if (at_end()) fail(begin, "the parenthesis is not closed");
    std::string text(line_.substr(begin + 1, at_ - begin - 1));
    ++at_;
    return text;
  }

  std::string_view line_;
  int number_;
  const std::string& file_;
  std::size_t at_ = 0;
};

}  // namespace

SiemensLine siemens_words(std::string_view line, int number, const std::string& file) {
  return LineReader(line, number, file).read();
}

}  // namespace servomill::controllers

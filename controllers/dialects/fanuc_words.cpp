#include "controllers/dialects/fanuc_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {
namespace {

constexpr int kMaxDigits = 8;               // of a number (B-63944EN, decimal point programming; M)
constexpr std::int64_t kMaxBlock = 99999;   // N
constexpr std::int64_t kMaxProgram = 9999;  // O
constexpr std::size_t kMaxLine = 1000;      // characters; a guard against other files

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// POPEN, PCLOS and DPRNT[...], external output of custom macro B (B-63944EN, external output
// commands; M), with or without a block number: they move nothing.
bool is_output(std::string_view line) {
  if (line.starts_with('N')) {
    const std::size_t end = line.find_first_not_of("0123456789", 1);
    line.remove_prefix(std::min(end, line.size()));
  }
  while (line.starts_with(' ')) line.remove_prefix(1);
  if (line == "POPEN" || line == "PCLOS") return true;
  constexpr std::string_view kPrint = "DPRNT[";
  return line.starts_with(kPrint) && line.ends_with(']') &&
         line.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789#[]*.-", kPrint.size() - 1) ==
             std::string_view::npos;
}

}  // namespace

double FanucWord::value() const {
  // a power of ten up to 10^8 and the mantissa are exact: one rounding, as in parsing the text
  constexpr std::array<double, kMaxDigits + 1> kPowers = {1e0, 1e1, 1e2, 1e3, 1e4,
                                                          1e5, 1e6, 1e7, 1e8};
  return static_cast<double>(mantissa) / kPowers[static_cast<std::size_t>(decimals)];
}

const FanucWord* FanucBlock::find(char letter) const {
  const auto found = std::find_if(words.begin(), words.end(),
                                  [&](const FanucWord& word) { return word.letter == letter; });
  return found == words.end() ? nullptr : &*found;
}

void FanucLexer::fail(std::size_t i, const std::string& message) const {
  throw servomill::InputError({file_, line_, static_cast<int>(i) + 1}, message);
}

std::optional<std::string_view> FanucLexer::next_line() {
  if (at_ >= text_.size()) return std::nullopt;
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  std::string_view line = text_.substr(at_, end - at_);
  at_ = end + 1;
  ++line_;
  if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
  if (line.size() > kMaxLine) {
    fail(kMaxLine, fmt::format("a block has at most {} characters here", kMaxLine));
  }
  return line;
}

// The first % opens the program, the second ends it.
bool FanucLexer::take_percent(std::string_view line) {
  if (line.empty() || line.front() != '%') return false;
  if (line.find_first_not_of(" \t", 1) != std::string_view::npos) {
    fail(1, "% must be alone on its line");
  }
  ++percents_;
  if (percents_ == 1 && has_begun_) percents_ = 2;
  return true;
}

std::optional<FanucBlock> FanucLexer::next() {
  while (percents_ < 2) {
    const auto line = next_line();
    if (!line) return std::nullopt;
    if (take_percent(*line) || is_output(*line)) continue;
    FanucBlock block = split(*line);
    if (!block.words.empty()) return block;
  }
  return std::nullopt;
}

FanucBlock FanucLexer::split(std::string_view line) {
  FanucBlock block;
  block.line = line_;
  bool is_first = true;
  for (std::size_t i = 0; i < line.size();) {
    const char c = line[i];
    if (c == ' ' || c == '\t') {
      ++i;
    } else if (c == '(') {
      const std::size_t end = line.find_first_of("()", i + 1);
      if (end == std::string_view::npos) fail(i, "a comment is not closed; ')' is missing");
      if (line[end] == '(') fail(end, "comment within a comment");
      i = end + 1;
    } else if (c == '/' && is_first) {
      block.has_slash = true;
      ++i;
      if (i < line.size() && line[i] == '1') ++i;
      if (i < line.size() && is_digit(line[i]))
        fail(i, "only the first block-delete switch '/' is supported");
      is_first = false;
    } else if (c >= 'A' && c <= 'Z') {
      const FanucWord one = word(line, i);
      keep(block, one);
      is_first = false;
    } else {
      fail(i, fmt::format("'{}' does not start a word", c));
    }
    has_begun_ = has_begun_ || !is_first;
  }
  return block;
}

FanucWord FanucLexer::word(std::string_view line, std::size_t& i) const {
  FanucWord out;
  out.letter = line[i];
  out.column = static_cast<int>(i) + 1;
  ++i;
  while (i < line.size() && (line[i] == ' ' || line[i] == '\t')) ++i;
  bool is_negative = false;
  if (i < line.size() && (line[i] == '-' || line[i] == '+')) is_negative = line[i++] == '-';
  int digits = 0, significant = 0;
  for (; i < line.size() && (is_digit(line[i]) || line[i] == '.'); ++i) {
    if (line[i] == '.') {
      if (out.has_point) fail(i, "a number with two decimal points");
      out.has_point = true;
      continue;
    }
    ++digits;
    significant += significant > 0 || line[i] != '0' ? 1 : 0;
    if (significant > kMaxDigits || (out.has_point && out.decimals == kMaxDigits)) {
      fail(i, fmt::format("a number has at most {} digits", kMaxDigits));
    }
    out.mantissa = 10 * out.mantissa + (line[i] - '0');
    out.decimals += out.has_point ? 1 : 0;
  }
  if (digits == 0) fail(i, fmt::format("{} requires a number", out.letter));
  if (is_negative) out.mantissa = -out.mantissa;
  return out;
}

void FanucLexer::keep(FanucBlock& block, const FanucWord& word) {
  const std::size_t i = static_cast<std::size_t>(word.column) - 1;
  if (word.letter == 'N') {
    if (!word.is_integer() || word.mantissa < 1 || word.mantissa > kMaxBlock) {
      fail(i, fmt::format("N must be an integer in 1 ... {}", kMaxBlock));
    }
    if (!block.words.empty()) fail(i, "N must be at the start of its block");
    return;
  }
  if (word.letter == 'O') {
    if (!word.is_integer() || word.mantissa < 1 || word.mantissa > kMaxProgram) {
      fail(i, fmt::format("O must be an integer in 1 ... {}", kMaxProgram));
    }
    if (has_name_ || has_begun_) fail(i, "O must be at the start of the program");
    has_name_ = true;
    return;
  }
  if (word.letter != 'G' && word.letter != 'M' && block.find(word.letter) != nullptr) {
    fail(i, fmt::format("{} appears twice in the block", word.letter));
  }
  block.words.push_back(word);
}

}  // namespace servomill::controllers

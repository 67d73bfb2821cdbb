#include "controllers/dialects/heidenhain_block.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

namespace servomill::controllers {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t'; }

bool is_upper(char c) { return c >= 'A' && c <= 'Z'; }

bool is_digit(char c) { return c >= '0' && c <= '9'; }

HeidenhainWord make_word(std::string_view text, Place place) {
  std::size_t letters = 0;
  while (letters < text.size() && is_upper(text[letters])) ++letters;
  return {std::string(text), std::string(text.substr(0, letters)),
          std::string(text.substr(letters)), std::move(place)};
}

// "0" behind FN, or "FN0": what a colon ends, with or without a blank behind it.
bool is_function(std::string_view text, const std::vector<HeidenhainWord>& before) {
  if (text.starts_with("FN")) {
    text.remove_prefix(2);
  } else if (before.empty() || before.back().text != "FN") {
    return false;
  }
  return !text.empty() && std::all_of(text.begin(), text.end(), is_digit);
}

void append_words(std::string_view text, const Place& line, std::vector<HeidenhainWord>& words) {
  std::size_t at = 0;
  while (at < text.size()) {
    if (is_space(text[at])) {
      ++at;
      continue;
    }
    std::size_t end = at;
    while (end < text.size() && !is_space(text[end])) {
      const bool ends_function = text[end] == ':' && is_function(text.substr(at, end - at), words);
      ++end;
      if (ends_function) break;
    }
    words.push_back(
        make_word(text.substr(at, end - at), {line.file, line.line, static_cast<int>(at) + 1}));
    at = end;
  }
}

// Number and '/' of a block, in either order: which one the control writes was not found.
void take_head(HeidenhainBlock& block) {
  auto& words = block.words;
  for (int i = 0; i < 2 && !words.empty(); ++i) {
    const HeidenhainWord& word = words.front();
    if (word.text.front() == '/' && !block.is_optional) {
      block.is_optional = true;
      const std::string rest = word.text.substr(1);
      Place place = word.place;
      ++place.column;
      if (rest.empty()) {
        words.erase(words.begin());
      } else {
        words.front() = make_word(rest, place);
        if (is_digit(rest.front())) --i;
      }
    } else if (is_digit(word.text.front()) && !block.number) {
      long number = 0;
      const char* end = word.text.data() + word.text.size();
      const auto [stop, error] = std::from_chars(word.text.data(), end, number);
      if (error != std::errc() || stop != end) {
        throw InputError(word.place, fmt::format("'{}' is not a block number", word.text));
      }
      block.number = number;
      words.erase(words.begin());
    }
  }
}

// True for a block without words other than its number and '/'.
bool has_head_only(HeidenhainBlock block) {
  take_head(block);
  return block.words.empty();
}

// Sign, digits, separator, digits; nothing else.
bool is_number(std::string_view digits, const HeidenhainFormat& format) {
  if (!digits.empty() && (digits.front() == '+' || digits.front() == '-')) {
    if (!format.has_sign) return false;
    digits.remove_prefix(1);
  }
  int count = 0;
  int separators = 0;
  for (const char c : digits) {
    if (is_digit(c)) {
      ++count;
    } else if (c == '.' || c == ',') {
      ++separators;
    } else {
      return false;
    }
  }
  return count > 0 && separators <= 1;
}

}  // namespace

struct HeidenhainBlocks::Line {
  std::string_view text;      // without its end and without a comment
  bool is_continued = false;  // ends with '~'
  bool has_comment = false;
};

HeidenhainBlocks::HeidenhainBlocks(std::string_view text, std::string file, int first_line,
                                   bool continues_comments)
    : rest_(text),
      file_(std::move(file)),
      line_(first_line),
      continues_comments_(continues_comments) {}

// A '~' continues a block also after a comment: the control writes names of parameters as comments.
HeidenhainBlocks::Line HeidenhainBlocks::take_line() {
  const std::size_t line_end = rest_.find('\n');
  Line line;
  line.text = rest_.substr(0, line_end);
  rest_ = line_end == std::string_view::npos ? std::string_view() : rest_.substr(line_end + 1);
  ++line_;
  if (!line.text.empty() && line.text.back() == '\r') line.text.remove_suffix(1);
  for (std::size_t i = 0; i < line.text.size(); ++i) {
    const auto c = static_cast<unsigned char>(line.text[i]);
    if ((c < ' ' && c != '\t') || c == 127) {
      throw InputError({file_, line_, static_cast<int>(i) + 1},
                       fmt::format("control character {}", static_cast<int>(c)));
    }
  }
  while (!line.text.empty() && is_space(line.text.back())) line.text.remove_suffix(1);
  if (!line.text.empty() && line.text.back() == '~') {
    line.is_continued = true;
    line.text.remove_suffix(1);
  }
  const std::size_t comment = line.text.find(';');
  if (comment != std::string_view::npos) {
    line.has_comment = true;
    line.text = line.text.substr(0, comment);
  }
  return line;
}

std::optional<HeidenhainBlock> HeidenhainBlocks::next() {
  Line line;
  do {
    if (rest_.empty()) return std::nullopt;
    line = take_line();
  } while (line.text.find_first_not_of(" \t") == std::string_view::npos && !line.has_comment &&
           !line.is_continued);
  HeidenhainBlock block;
  block.place = {file_, line_, 1};
  append_words(line.text, block.place, block.words);
  const bool is_comment = line.has_comment && has_head_only(block);
  while (line.is_continued) {
    if (is_comment && !continues_comments_) {
      throw InputError(block.place, "a comment that ends with '~' may continue on the next line");
    }
    if (rest_.empty()) {
      throw InputError({file_, line_, 0}, "'~' continues the block, but no line follows");
    }
    line = take_line();
    block.is_continued_comment = is_comment;
    if (!is_comment) append_words(line.text, {file_, line_, 0}, block.words);
  }
  take_head(block);
  if (!block.words.empty()) block.place = block.words.front().place;
  // '*' begins a structure item, a comment in the list of blocks
  if (!block.words.empty() && block.words.front().text.front() == '*') block.words.clear();
  return block;
}

double heidenhain_number(const HeidenhainWord& word, std::string_view digits,
                         const HeidenhainFormat& format) {
  if (digits.empty())
    throw InputError(word.place, fmt::format("'{}' requires a number", word.text));
  if (digits.find('Q') != std::string_view::npos) {
    throw InputError(word.place, fmt::format("'{}': Q parameters are not covered by the "
                                             "verification",
                                             word.text));
  }
  if (!is_number(digits, format)) {
    throw InputError(word.place, fmt::format("'{}': '{}' is not a number{}", word.text, digits,
                                             format.has_sign ? "" : " without a sign"));
  }
  const std::size_t separator = digits.find_first_of(".,");
  const std::size_t decimals =
      separator == std::string_view::npos ? 0 : digits.size() - separator - 1;
  if (decimals > static_cast<std::size_t>(format.decimals)) {
    throw InputError(word.place, fmt::format("'{}': the control accepts {} decimals here",
                                             word.text, format.decimals));
  }
  std::string text;
  for (const char c : digits) {
    if (c != '+') text.push_back(c == ',' ? '.' : c);
  }
  double value = 0.0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  if (std::abs(value) > format.max) {
    throw InputError(word.place, fmt::format("'{}': the control accepts up to {}{} here", word.text,
                                             format.has_sign ? "+-" : "", format.max));
  }
  return value;
}

}  // namespace servomill::controllers

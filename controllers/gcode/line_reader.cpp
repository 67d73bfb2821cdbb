#include "controllers/gcode/line_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>

#include "plant/vocabulary/input_error.h"

namespace servomill::controllers {
namespace {

bool is_blank_at(char c) { return c == ' ' || c == '\t'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }
bool is_letter(char c) { return upper(c) >= 'A' && upper(c) <= 'Z'; }

// One pass over a line, from left to right; every rule puts characters of the same number.
class LexicalRules {
 public:
  LexicalRules(std::string_view line, Reader reader)
      : line_{std::string(line), {}}, reader_(reader) {}

  TolerantLine result() {
    control_characters();
    skip_blanks();
    if (at_ < text().size() && text()[at_] == '%') return percent_title(), std::move(line_);
    slashes();
    program_number();
    while (at_ < text().size()) item();
    return std::move(line_);
  }

 private:
  std::string& text() { return line_.text; }
  const std::string& text() const { return line_.text; }
  char at(std::size_t i) const { return i < line_.text.size() ? line_.text[i] : '\0'; }

  bool apply(ReaderRule rule, std::size_t column) {
    if (!has_rule(reader_, rule)) return false;
    const bool is_known = std::any_of(line_.applied.begin(), line_.applied.end(),
                                      [&](const AppliedRule& one) { return one.rule == rule; });
    if (!is_known) line_.applied.push_back({rule, static_cast<int>(column) + 1});
    return true;
  }
  void blank(std::size_t begin, std::size_t end) {
    std::fill(text().begin() + static_cast<std::ptrdiff_t>(begin),
              text().begin() + static_cast<std::ptrdiff_t>(end), ' ');
  }
  void skip_blanks() {
    while (is_blank_at(at(at_))) ++at_;
  }
  std::size_t digits_end(std::size_t from) const {
    while (is_digit(at(from))) ++from;
    return from;
  }

  void control_characters() {
    for (std::size_t i = 0; i < text().size(); ++i) {
      const auto byte = static_cast<unsigned char>(text()[i]);
      const bool is_end = text()[i] == '\r' && i + 1 == text().size();
      if ((byte >= 0x20 && byte != 0x7f) || text()[i] == '\t' || is_end) continue;
      if (apply(ReaderRule::control_characters, i)) text()[i] = ' ';
    }
  }

  void percent_title() {
    const std::size_t title = text().find_first_not_of(" \t\r", at_ + 1);
    if (title == std::string::npos) return;
    if (apply(ReaderRule::percent_title, title)) blank(at_ + 1, text().size());
  }

  // '//' before what no control reads as a word, and levels of '/'.
  void slashes() {
    if (at(at_) != '/') return;
    if (at(at_ + 1) == '/') {
      const std::size_t first = text().find_first_not_of("/ \t", at_);
      const bool is_word =
          first != std::string::npos && is_letter(at(first)) && !is_letter(at(first + 1));
      if (is_word || !apply(ReaderRule::slash_comment, at_)) return;
      text()[at_] = ';';
      return;
    }
    if (is_digit(at(at_ + 1)) && !is_digit(at(at_ + 2)) && apply(ReaderRule::skip_level, at_ + 1)) {
      text()[at_ + 1] = ' ';
    }
    ++at_;
    skip_blanks();
  }

  void program_number() {
    if (at(at_) == ':' && is_digit(at(at_ + 1)) && apply(ReaderRule::colon_number, at_)) {
      text()[at_] = 'O';
    }
    if (upper(at(at_)) != 'O' || !is_digit(at(at_ + 1))) return;
    const std::size_t end = digits_end(at_ + 1);
    std::size_t next = end;
    while (is_blank_at(at(next))) ++next;
    // no keyword of an O-word begins with these
    constexpr std::string_view kWords = "GMTNXYZFS";
    const bool is_word = kWords.find(upper(at(next))) != std::string_view::npos &&
                         (is_digit(at(next + 1)) || at(next + 1) == '-' || at(next + 1) == '.');
    if (is_word && apply(ReaderRule::number_with_words, next)) blank(at_, end);
    at_ = end;
  }

  void item() {
    const char c = at(at_);
    if (c == ';') {
      at_ = text().size();
    } else if (c == '(') {
      comment();
    } else if (c == '[' || c == '<') {
      skip_bracketed();
    } else if (upper(c) == 'N' && is_digit(at(at_ + 1))) {
      block_number();
    } else if (is_fan_code()) {
      fan_code();
    } else if (is_letter(c)) {
      while (is_letter(at(at_))) ++at_;
      if (upper(at(at_ - 1)) == 'N' && is_digit(at(at_))) return;  // ... 1N20: never after a word
    } else {
      seen_ = seen_ || !is_blank_at(c);
      ++at_;
      return;
    }
    seen_ = true;
  }

  void block_number() {
    const std::size_t begin = at_;
    at_ = digits_end(at_ + 1);
    if (at(at_) == '.') at_ = digits_end(at_ + 1);
    if (seen_ && apply(ReaderRule::block_number_anywhere, begin)) blank(begin, at_);
  }

  bool is_fan_code() const {
    const std::string_view rest = std::string_view(text()).substr(at_);
    const bool is_code =
        upper(rest[0]) == 'M' && (rest.substr(1, 3) == "106" || rest.substr(1, 3) == "107");
    return is_code && !is_digit(at(at_ + 4)) && at(at_ + 4) != '.';
  }

  // With its S or P word, which would set the speed of the spindle.
  void fan_code() {
    const std::size_t begin = at_;
    at_ += 4;
    skip_blanks();
    if (upper(at(at_)) == 'S' || upper(at(at_)) == 'P') {
      at_ = digits_end(at_ + 1);
      if (at(at_) == '.') at_ = digits_end(at_ + 1);
    }
    if (apply(ReaderRule::fan_code, begin)) blank(begin, at_);
  }

  void skip_bracketed() {
    const char open = at(at_), close = open == '[' ? ']' : '>';
    int depth = 0;
    for (; at_ < text().size(); ++at_) {
      if (at(at_) == open) ++depth;
      if (at(at_) == close && --depth == 0) break;
    }
    at_ = std::min(at_ + 1, text().size());
  }

  // From '(' to the ')' that closes it; what is between stays a comment.
  void comment() {
    const std::size_t open = at_;
    int depth = 0;
    std::size_t end = open, first = std::string::npos;
    for (; end < text().size(); ++end) {
      if (at(end) == '(') ++depth;
      if (at(end) != ')') continue;
      first = std::min(first, end);
      if (--depth == 0) break;
    }
    at_ = std::min(end + 1, text().size());
    const bool is_nested = text().find('(', open + 1) < at_;
    if (depth > 0 && first == std::string::npos) {
      if (apply(ReaderRule::open_comment, open)) text()[open] = ';';
      return;
    }
    if (!is_nested || depth > 0 || has_words(first + 1, end)) return;
    if (!apply(ReaderRule::nested_comment, text().find('(', open + 1))) return;
    for (std::size_t i = open + 1; i < end; ++i) {
      if (at(i) == '(') text()[i] = '[';
      if (at(i) == ')') text()[i] = ']';
    }
  }

  // Detects words that a control which ends the comment at its first ')' would read.
  bool has_words(std::size_t begin, std::size_t end) const {
    for (std::size_t i = begin; i + 1 < end; ++i) {
      const bool is_number = is_digit(at(i + 1)) || at(i + 1) == '-' || at(i + 1) == '.';
      if (is_letter(at(i)) && is_number && (i == begin || !is_letter(at(i - 1)))) return true;
    }
    return false;
  }

  TolerantLine line_;
  Reader reader_;
  std::size_t at_ = 0;
  bool seen_ = false;  // anything but a block number
};

// Codes that the parser takes and no table holds.
bool has_fan_code(const Block& block) {
  return std::any_of(block.words.begin(), block.words.end(), [](const Word& word) {
    return word.letter == 'M' && word.value.is_constant() &&
           (word.value.number == 106.0 || word.value.number == 107.0);
  });
}

bool contains_word(std::string_view line, std::string_view word) {
  const std::size_t at = line.find(word);
  if (at == std::string_view::npos) return false;
  const bool begins = at == 0 || !is_letter(line[at - 1]);
  const std::size_t end = at + word.size();
  return begins && (end == line.size() || !is_letter(line[end]));
}

}  // namespace

TolerantLine tolerant_line(std::string_view line, Reader reader) {
  return LexicalRules(line, reader).result();
}

std::string other_language(std::string_view line, int column) {
  for (const std::string_view word : {"BEGIN PGM", "TOOL CALL", "CYCL DEF", "BLK FORM"}) {
    if (contains_word(line, word)) {
      return fmt::format("'{}' is Heidenhain conversational; --reader heidenhain reads it", word);
    }
  }
  for (const std::string_view word : {"TRAORI", "TRAFOOF", "SUPA", "MCALL", "CYCLE", "POCKET",
                                      "SLOT", "HOLES", "MSG", "DEF", "WORKPIECE", "EXTERN"}) {
    const std::size_t at = line.find(word);
    const bool is_first =
        at != std::string_view::npos &&
        line.substr(0, at).find_first_not_of("N0123456789 \t") == std::string_view::npos;
    if (!is_first) continue;
    return fmt::format("'{}' is a word of Siemens' language; programs in G-code are read here",
                       word);
  }
  const auto at = static_cast<std::size_t>(column - 1);
  if (column > 0 && at + 1 < line.size() && upper(line[at]) == 'E' &&
      (is_digit(line[at + 1]) || line[at + 1] == '-' || line[at + 1] == '.')) {
    return "an E word feeds the extruder of a printer; programs for milling are read here";
  }
  return {};
}

void LineReader::parse(std::string_view& line, const std::string& file, int number, Block& block,
                       Parser::Extent extent) {
  tolerant_.applied.clear();
  try {
    parser_.parse(line, file, number, block, extent);
    if (!has_rule(reader_, ReaderRule::fan_code) || !has_fan_code(block)) return;
    tolerant_ = tolerant_line(line, reader_);
  } catch (const InputError& error) {
    const int column = error.faults().front().place.column;
    const std::string language = other_language(line, column);
    if (!language.empty()) throw InputError({file, number, column}, language);
    tolerant_ = tolerant_line(line, reader_);
    if (tolerant_.applied.empty()) throw;
  }
  parser_.parse(tolerant_.text, file, number, block, extent);
  line = tolerant_.text;
}

}  // namespace servomill::controllers

#include "controllers/gcode/line_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <utility>

#include "controllers/gcode/other_language.h"
#include "controllers/gcode/repeated_words.h"
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
      : line_{std::string(line), {}, {}}, reader_(reader) {}

  TolerantLine result() {
    control_characters();
    long_comment();
    skip_blanks();
    if (sender_wait()) return std::move(line_);
    if (at_ < text().size() && text()[at_] == '%') return percent_title(), std::move(line_);
    if (sender_command()) return std::move(line_);
    checksum();
    skip_behind_number();
    slashes();
    program_number();
    home_letters();
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

  // G28 X Y becomes G28.2X0Y0; what stands behind it is a comment.
  void home_letters() {
    const std::size_t end = std::min(text().find_first_of("(;", at_), text().size());
    const std::size_t code = text().find("G28", at_);
    if (code >= end || is_digit(at(code + 3)) || at(code + 3) == '.') return;
    std::string words = "G28.2", letters;
    for (std::size_t i = code + 3; i < end; ++i) {
      if (is_blank_at(at(i)) || at(i) == '\r') continue;
      const char letter = upper(at(i));
      if (std::string_view("XYZABC").find(letter) == std::string_view::npos) return;
      if (letters.find(letter) != letters.npos) return;
      words += std::string(1, letter) + "0";
      letters += letter;
    }
    if (letters.empty() || !apply(ReaderRule::home_letters, code)) return;
    text().replace(code, end - code, words);
  }

  bool sender_command() {
    const bool is_request = is_report_request(std::string_view(text()).substr(at_));
    if (!is_request || !apply(ReaderRule::sender_command, at_)) return false;
    blank(at_, std::min(text().find_first_of(" \t;\r", at_), text().size()));
    return true;
  }

  // %wait alone, in small letters as the senders compare it, becomes a dwell of no duration.
  bool sender_wait() {
    constexpr std::string_view kWait = "%wait", kRest = "G4 P0";
    static_assert(kWait.size() == kRest.size());
    const bool is_wait = text().compare(at_, kWait.size(), kWait) == 0;
    const std::size_t next = text().find_first_not_of(" \t\r", at_ + kWait.size());
    const bool is_alone = next == std::string::npos || at(next) == ';';
    if (!is_wait || !is_alone || !apply(ReaderRule::sender_wait, at_)) return false;
    text().replace(at_, kWait.size(), kRest);
    return true;
  }

  // N10 G0 X1 *45
  void checksum() {
    const std::size_t last = text().find_last_not_of(" \t\r");
    if (last == std::string::npos || !is_digit(text()[last])) return;
    const std::size_t star = text().find_last_not_of("0123456789", last);
    const bool is_checksum = star != std::string::npos && star > 0 && text()[star] == '*' &&
                             text()[star - 1] != '*' && text().find_first_of("[#(;") == text().npos;
    if (is_checksum && apply(ReaderRule::checksum, star)) blank(star, last + 1);
  }

  // Cuts a comment that goes beyond the longest line; what it says has no effect.
  void long_comment() {
    if (text().size() <= kLongestLine) return;
    const std::size_t open = text().find_last_of("(;", kLongestLine - 2);
    if (open == std::string::npos) return;
    const bool is_line_comment = text()[open] == ';';
    const std::size_t close = text().find_last_not_of(" \t\r");
    const bool is_closed =
        close != std::string::npos && text()[close] == ')' && text().find(')', open) == close;
    if (!is_line_comment && !is_closed) return;
    if (!apply(ReaderRule::long_comment, kLongestLine)) return;
    text().resize(kLongestLine);
    if (!is_line_comment) text().back() = ')';
  }

  void percent_title() {
    const std::size_t title = text().find_first_not_of(" \t\r", at_ + 1);
    if (title == std::string::npos) return;
    if (apply(ReaderRule::percent_title, title)) blank(at_ + 1, text().size());
  }

  // N10 /G0 X1: the slash and the number change places.
  void skip_behind_number() {
    if (upper(at(at_)) != 'N' || !is_digit(at(at_ + 1))) return;
    const std::size_t end = digits_end(at_ + 1);
    std::size_t slash = end;
    while (is_blank_at(at(slash))) ++slash;
    if (at(slash) != '/' || at(slash + 1) == '/') return;
    if (!apply(ReaderRule::skip_behind_number, slash)) return;
    for (std::size_t i = end; i > at_; --i) text()[i] = text()[i - 1];
    text()[at_] = '/';
    if (slash != end) text()[slash] = ' ';
  }

  // '//' before what no control reads as a word, and levels of '/'.
  void slashes() {
    if (at(at_) != '/') return;
    if (at(at_ + 1) == '/') {
      const std::size_t first = text().find_first_not_of("/ \t", at_);
      const bool is_block = first != std::string::npos && is_letter(at(first)) &&
                            !is_letter(at(first + 1)) && !has_name(first);
      if (is_block || !apply(ReaderRule::slash_comment, at_)) return;
      text()[at_] = ';';
      return;
    }
    if (is_digit(at(at_ + 1)) && !is_digit(at(at_ + 2)) && apply(ReaderRule::skip_level, at_ + 1)) {
      text()[at_ + 1] = ' ';
    }
    ++at_;
    skip_blanks();
  }

  // Three letters in a row outside of brackets: a text, and no block of words.
  bool has_name(std::size_t begin) const {
    const std::size_t end = std::min(text().find_first_of("(;[<", begin), text().size());
    int letters = 0;
    for (std::size_t i = begin; i < end && letters < 3; ++i) {
      letters = is_letter(at(i)) ? letters + 1 : 0;
    }
    return letters == 3;
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
    } else if (is_code('M', "106") || is_code('M', "107")) {
      fan_code();
    } else if (is_code('G', "187")) {
      smoothness();
    } else if (c == ',' && corner_end() > at_ && apply(ReaderRule::corner, at_)) {
      corner();
    } else if (is_dwell_ && upper(c) == 'U' && apply(ReaderRule::dwell_word, at_)) {
      text()[at_++] = 'X';
    } else if (is_letter(c)) {
      is_dwell_ = is_dwell_ || is_code('G', "4") || is_code('G', "04");
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

  bool is_code(char letter, std::string_view digits) const {
    const std::size_t end = at_ + 1 + digits.size();
    return upper(at(at_)) == letter && text().compare(at_ + 1, digits.size(), digits) == 0 &&
           !is_digit(at(end)) && at(end) != '.';
  }

  // G187 P E of Haas; E is a word of nothing else.
  void smoothness() {
    const std::size_t begin = at_;
    at_ += 4;
    for (skip_blanks(); upper(at(at_)) == 'P' || upper(at(at_)) == 'E'; skip_blanks()) {
      at_ = digits_end(at_ + 1);
      if (at(at_) == '.') at_ = digits_end(at_ + 1);
    }
    if (apply(ReaderRule::smoothing, begin)) blank(begin, at_);
  }

  // End of ",R5." that begins here, if its value is a plain number; else the begin.
  std::size_t corner_end() const {
    const std::size_t letter = text().find_first_not_of(" \t", at_ + 1);
    if (letter == text().npos || (upper(at(letter)) != 'R' && upper(at(letter)) != 'C')) return at_;
    std::size_t begin = letter + 1;
    while (is_blank_at(at(begin))) ++begin;
    std::size_t end = digits_end(begin);
    if (at(end) == '.') end = digits_end(end + 1);
    const bool is_number = end > begin && (end > begin + 1 || at(begin) != '.');
    return is_number && !line_.corner ? end : at_;
  }

  void corner() {
    const std::size_t end = corner_end();
    const std::size_t letter = text().find_first_not_of(" \t", at_ + 1);
    const std::string value = text().substr(letter + 1, end - letter - 1);
    line_.corner = {upper(at(letter)), std::strtod(value.c_str(), nullptr),
                    static_cast<int>(at_) + 1, value.find('.') != value.npos};
    blank(at_, end);
    at_ = end;
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
    if (!is_nested || depth > 0) return;
    if (!is_comment_behind(first, end) && has_words(first + 1, end)) return;
    if (!apply(ReaderRule::nested_comment, text().find('(', open + 1))) return;
    for (std::size_t i = open + 1; i < end; ++i) {
      if (at(i) == '(') text()[i] = '[';
      if (at(i) == ')') text()[i] = ']';
    }
  }

  // "(mill (6 mm); S5 (fast))": behind the first ')' there is a comment, too, up to the end.
  bool is_comment_behind(std::size_t first, std::size_t end) const {
    const std::size_t next = text().find_first_not_of(" \t", first + 1);
    return at(next) == ';' && text().find_first_not_of(" \t\r", end + 1) == std::string::npos;
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
  bool seen_ = false, is_dwell_ = false;  // anything but a block number; G4
};

// M106 and M107.
bool has_fan_code(const Block& block) {
  return std::any_of(block.words.begin(), block.words.end(), [](const Word& word) {
    return word.letter == 'M' && word.value.is_constant() &&
           (word.value.number == 106.0 || word.value.number == 107.0);
  });
}

// A line that is skipped is read for its label only.
bool begins_with_colon(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t");
  return first != std::string_view::npos && line[first] == ':';
}

}  // namespace

TolerantLine tolerant_line(std::string_view line, Reader reader) {
  TolerantLine out = LexicalRules(line, reader).result();
  drop_repeated_words(out, reader);
  return out;
}

void LineReader::parse(std::string_view& line, const std::string& file, int number, Block& block,
                       Parser::Extent extent) {
  tolerant_.applied.clear();
  tolerant_.corner.reset();
  try {
    if (extent != Parser::Extent::all && begins_with_colon(line)) {
      tolerant_ = tolerant_line(line, reader_);
      line = tolerant_.text;
    }
    parser_.parse(line, file, number, block, extent);
    if (!reads_fan_codes_ || !has_fan_code(block)) return;
    tolerant_ = tolerant_line(line, reader_);
    line = tolerant_.text;
  } catch (const InputError& error) {
    const int column = error.faults().front().place.column;
    TolerantLine other = tolerant_line(line, reader_);  // `line` may be the text of the last one
    const std::string language = other_language(other.corner ? other.text : line, column);
    if (!language.empty()) throw InputError({file, number, column}, language);
    if (other.applied.empty() && line.starts_with("//")) {
      throw InputError({file, number, column},
                       "'//' before words: a comment on some controls, an optional block on "
                       "others; use ( ) or ;");
    }
    if (other.applied.empty()) throw;
    tolerant_ = std::move(other);
    line = tolerant_.text;
  }
  parser_.parse(line, file, number, block, extent);
}

}  // namespace servomill::controllers

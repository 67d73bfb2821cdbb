#include "controllers/gcode/macro/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "controllers/gcode/number_text.h"
#include "controllers/gcode/readers/block_words.h"

namespace servomill::controllers::macro {
namespace {

constexpr std::string_view kLengths = "XYZUVWIJKRQ", kAngles = "ABC", kCounts = "MSTDHL";

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_letter(char c) { return c >= 'A' && c <= 'Z'; }
bool has(std::string_view letters, char c) { return letters.find(c) != std::string_view::npos; }

class WordReader {
 public:
  WordReader(std::string_view body, std::size_t begin, const Expression::Context& context,
             const WordUnits& units)
      : body_(body), context_(context), units_(units), cursor_(body) {
    cursor_.go_to(begin);
  }

  std::vector<MacroWord> all() {
    std::vector<MacroWord> words;
    while (!cursor_.at_end()) words.push_back(word());
    return words;
  }

 private:
  [[noreturn]] void refuse(int column, std::string message) const {
    context_.reading.refuse({context_.file, context_.line, column}, std::move(message));
  }

  MacroWord word() {
    MacroWord word;
    word.letter = cursor_.peek();
    word.begin = cursor_.at();
    if (!is_letter(word.letter)) refuse_character();
    cursor_.advance();
    Cursor sign = cursor_;
    if (sign.peek() == '-' || sign.peek() == '+') sign.advance();
    word.is_literal = is_digit(sign.peek()) || sign.peek() == '.';
    word.is_literal ? literal(word) : expression(word);
    word.end = cursor_.at();
    while (word.end > word.begin && has(" \t\r", body_[word.end - 1])) --word.end;
    return word;
  }

  void refuse_character() const {
    const int column = cursor_.column();
    if (cursor_.peek() == '#') {
      refuse(column, "a macro statement must be in a separate block");
    }
    if (has("+-*/]", cursor_.peek())) {
      refuse(
          column,
          fmt::format(
              "unexpected '{}': an expression of several terms must be in brackets, as in X[#1+5]",
              cursor_.peek()));
    }
    refuse(column, fmt::format("unexpected '{}'; a word starts with a letter", cursor_.peek()));
  }

  void literal(MacroWord& word) {
    std::string text;
    if (cursor_.peek() == '-') text += '-';
    if (!is_digit(cursor_.peek()) && cursor_.peek() != '.') cursor_.advance();
    for (; is_digit(cursor_.peek()) || cursor_.peek() == '.'; cursor_.advance()) {
      word.has_point = word.has_point || cursor_.peek() == '.';
      word.digits += cursor_.peek() == '.' ? 0 : 1;
      text += cursor_.peek();
    }
    double value = 0.0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) {
      refuse(word.column(), fmt::format("{}{} is not a number", word.letter, text));
    }
    word.value = value;
  }

  void expression(MacroWord& word) {
    const char next = cursor_.peek();
    if (!has("#[-+", next)) {
      refuse(word.column(),
             fmt::format("expected a value after {}: a number, #1 or an expression in brackets",
                         word.letter));
    }
    if (word.letter == 'N' || word.letter == 'O') {
      refuse(word.column(), fmt::format("{} requires a number, not a variable", word.letter));
    }
    const double increment = units_.are_arguments ? 0.0 : increment_of(word.letter, units_.is_inch);
    Expression reader(
        body_, cursor_.at(),
        {context_.variables, context_.reading, context_.file, context_.line, increment});
    word.value = reader.word_value();
    cursor_ = reader.cursor();
  }

  std::string_view body_;
  const Expression::Context& context_;
  const WordUnits& units_;
  Cursor cursor_;
};

std::string with_point(std::string text) {
  if (text.find('.') == std::string::npos) text += '.';
  return text;
}

// As the control has it in the word of an address: lengths with a point, so that no reader takes
// them for increments.
std::string text_of(const MacroWord& word, const Expression::Context& context,
                    const WordUnits& units) {
  const double value = *word.value, increment = increment_of(word.letter, units.is_inch);
  const Place place{context.file, context.line, word.column()};
  if (increment > 0.0) {
    const double rounded = rounded_to(value, increment);
    if (std::abs(rounded - value) > 1e-9) {
      context.reading.apply(ReaderRule::variable_increment, place);
    }
    return word.letter + with_point(fixed_text(rounded, units.is_inch ? 4 : 3));
  }
  if (has(kCounts, word.letter))
    return fmt::format("{}{:.0f}", word.letter, rounded_to(value, 1.0));
  if (word.letter == 'G') return word.letter + fixed_text(value, 1);
  if (word.letter == 'P') return word.letter + significant_text(value);
  return word.letter + with_point(significant_text(value));
}

}  // namespace

double increment_of(char letter, bool is_inch) {
  if (has(kAngles, letter)) return 1e-3;
  return has(kLengths, letter) ? (is_inch ? 1e-4 : 1e-3) : 0.0;
}

int MacroWord::tenths() const { return value && !is_erased ? tenths_of(*value) : -1; }

std::vector<MacroWord> read_words(std::string_view body, std::size_t begin,
                                  const Expression::Context& context, const WordUnits& units) {
  return WordReader(body, begin, context, units).all();
}

void ExpandedLine::set(std::string_view text) {
  line_.set(text);
  has_words_ = !text.empty();
}

void ExpandedLine::set(std::string_view text, const std::vector<MacroWord>& words,
                       const Expression::Context& context, const WordUnits& units) {
  line_.clear();
  has_words_ = false;
  std::size_t at = 0;
  for (const MacroWord& word : words) {
    line_.copy(text.substr(at, word.begin - at), static_cast<int>(at) + 1);
    at = word.end;
    if (word.is_erased || !word.value) {
      line_.trim_end(" ");
      continue;
    }
    has_words_ = true;
    if (word.is_literal) {
      line_.copy(text.substr(word.begin, word.end - word.begin), word.column());
    } else {
      line_.replace(text_of(word, context, units), word.column());
    }
  }
  line_.copy(text.substr(at), static_cast<int>(at) + 1);
}

}  // namespace servomill::controllers::macro

#include "controllers/gcode/repeated_words.h"

#include <algorithm>
#include <cstdlib>
#include <map>
#include <utility>

namespace servomill::controllers {
namespace {

bool is_of_number(char c) {
  return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+' || c == ' ' || c == '\t';
}

char upper(char c) { return c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c; }

// A letter and its number, up to the next letter.
struct PlainWord {
  std::size_t begin = 0, end = 0;
  double value = 0.0;
  bool is_number = false;  // and no variable or expression
};

PlainWord word_at(const std::string& text, std::size_t begin) {
  PlainWord word{begin, begin + 1, 0.0, false};
  while (word.end < text.size() && is_of_number(text[word.end])) ++word.end;
  std::string digits = text.substr(begin + 1, word.end - begin - 1);
  std::erase_if(digits, [](char c) { return c == ' ' || c == '\t'; });
  char* stop = nullptr;
  word.value = std::strtod(digits.c_str(), &stop);
  const bool goes_on = word.end < text.size() && (text[word.end] == '#' || text[word.end] == '[');
  word.is_number = !digits.empty() && *stop == '\0' && !goes_on;
  return word;
}

}  // namespace

// G and M words may be repeated. Other words that differ are left to the parser, which
// refuses them, but for feed and speed.
void drop_repeated_words(TolerantLine& line, Reader reader) {
  std::string& text = line.text;
  const bool has_other = text.find_first_of("#[<%") != std::string::npos;
  if (has_other || !has_rule(reader, ReaderRule::repeated_word)) return;
  const std::size_t end = std::min(text.find_first_of("(;"), text.size());
  std::map<char, PlainWord> last;
  for (std::size_t at = 0; at < end; ++at) {
    const char letter = upper(text[at]);
    if (letter < 'A' || letter > 'Z' || letter == 'G' || letter == 'M') continue;
    const PlainWord word = word_at(text, at);
    const auto [known, is_new] = last.try_emplace(letter, word);
    if (is_new) continue;
    const PlainWord before = std::exchange(known->second, word);
    const bool may_differ = letter == 'F' || letter == 'S';
    if (!word.is_number || !before.is_number) continue;
    if (before.value != word.value && !may_differ) continue;
    std::fill(text.begin() + static_cast<std::ptrdiff_t>(before.begin),
              text.begin() + static_cast<std::ptrdiff_t>(before.end), ' ');
    const bool is_noted =
        std::any_of(line.applied.begin(), line.applied.end(),
                    [](const AppliedRule& one) { return one.rule == ReaderRule::repeated_word; });
    if (!is_noted) {
      line.applied.push_back({ReaderRule::repeated_word, static_cast<int>(word.begin) + 1});
    }
  }
}

}  // namespace servomill::controllers

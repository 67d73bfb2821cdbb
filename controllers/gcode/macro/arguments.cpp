#include "controllers/gcode/macro/arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

namespace servomill::controllers::macro {
namespace {

// By letter; I, J and K count on.
constexpr std::array<int, 26> kVariables = {1, 2, 3, 7,  8,  9,  0,  11, 4,  5,  6,  0,  13,
                                            0, 0, 0, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26};
constexpr std::string_view kSets = "IJK", kWholeNumbers = "DHMST", kNoLength = "EF";

Place place_of(const MacroWord& word, const Expression::Context& context) {
  return {context.file, context.line, word.column()};
}

// I J K are #4 #5 #6; a letter that does not follow the one before begins the next set.
class Sets {
 public:
  int variable(char letter) {
    const auto at = static_cast<int>(kSets.find(letter));
    if (at <= last_) ++set_;
    last_ = at;
    return 4 + 3 * set_ + at;
  }

 private:
  int last_ = -1, set_ = 0;
};

double argument_value(const MacroWord& word, const Expression::Context& context,
                      const WordUnits& units) {
  const double value = *word.value;
  const bool is_plain = !word.is_literal || word.has_point || value == 0.0 ||
                        kWholeNumbers.find(word.letter) != std::string_view::npos;
  if (is_plain || context.reading.decimal_point() == DecimalPoint::calculator) return value;
  if (context.reading.decimal_point() == DecimalPoint::unset) {
    context.reading.choose(WordDifference::argument_point, place_of(word, context));
  }
  if (kNoLength.find(word.letter) != std::string_view::npos) {
    context.reading.fail(place_of(word, context),
                         fmt::format("argument {} without a decimal point: its increment depends "
                                     "on parameters; add the decimal point",
                                     word.letter));
  }
  return value * increment_of(word.letter, units.is_inch);
}

long whole(const MacroWord& word, long least, const Expression::Context& context) {
  const double nearest = std::round(*word.value);
  if (std::abs(*word.value - nearest) > 1e-4 || nearest < static_cast<double>(least) ||
      nearest > 99'999'999.0) {
    context.reading.refuse(
        place_of(word, context),
        fmt::format("{}{}; must be an integer of at least {}", word.letter, *word.value, least));
  }
  return std::lround(nearest);
}

const MacroWord* find(const std::vector<MacroWord>& words, char letter) {
  const auto found = std::find_if(words.begin(), words.end(), [&](const MacroWord& word) {
    return word.letter == letter && word.value && !word.is_erased;
  });
  return found == words.end() ? nullptr : &*found;
}

// P51002: five times program 1002.
void split_repetitions(const MacroWord& P, bool has_L, MacroCall& call,
                       const Expression::Context& context) {
  constexpr long kNumbers = 10000;
  if (call.number < kNumbers) return;
  if (context.reading.choose(WordDifference::subprogram_digits, place_of(P, context)) == 0) return;
  if (has_L) context.reading.refuse(place_of(P, context), "L is not allowed with repetitions in P");
  context.reading.apply(ReaderRule::subprogram_repeats, place_of(P, context));
  call.turns = call.number / kNumbers;
  call.number %= kNumbers;
}

}  // namespace

MacroCall macro_call(const std::vector<MacroWord>& words, const MacroWord& code,
                     const Expression::Context& context, const WordUnits& units) {
  MacroCall call;
  call.locals.emplace();
  Sets sets;
  const std::string name = code.tenths() == 650 ? "G65" : "G66";
  const MacroWord* P = find(words, 'P');
  if (P == nullptr) {
    context.reading.refuse(place_of(code, context),
                           fmt::format("{} requires a P word (program number)", name));
  }
  call.number = whole(*P, 1, context);
  call.column = P->column();
  for (const MacroWord& word : words) {
    if (&word == &code || word.letter == 'P' || !word.value) continue;
    if (word.begin < code.begin) {
      context.reading.refuse(
          place_of(word, context),
          fmt::format("{0} must precede its arguments; program {1} in a separate block", name,
                      word.letter));
    }
    if (word.letter == 'L') {
      call.turns = whole(word, 1, context);
      continue;
    }
    const bool is_of_set = kSets.find(word.letter) != std::string_view::npos;
    const int variable = is_of_set ? sets.variable(word.letter)
                                   : kVariables[static_cast<std::size_t>(word.letter - 'A')];
    if (variable == 0 || variable > kLocals) {
      context.reading.refuse(place_of(word, context),
                             fmt::format("{} is not an argument of {}", word.letter, name));
    }
    (*call.locals)[static_cast<std::size_t>(variable)] = argument_value(word, context, units);
  }
  return call;
}

MacroCall subprogram_call(std::vector<MacroWord>& words, MacroWord& code,
                          const Expression::Context& context) {
  MacroCall call;
  call.is_block = code.tenths() == 970;
  const MacroWord* P = find(words, 'P');
  const MacroWord* L = find(words, 'L');
  if (P == nullptr) {
    context.reading.refuse(place_of(code, context),
                           call.is_block ? "M97 requires a P word (block number)"
                                         : "M98 requires a P word (subprogram number)");
  }
  call.number = whole(*P, 0, context);
  call.column = P->column();
  if (L != nullptr) call.turns = whole(*L, 1, context);
  if (!call.is_block) split_repetitions(*P, L != nullptr, call, context);
  for (MacroWord& word : words) {
    word.is_erased = word.is_erased || &word == &code || &word == P || &word == L;
  }
  return call;
}

}  // namespace servomill::controllers::macro

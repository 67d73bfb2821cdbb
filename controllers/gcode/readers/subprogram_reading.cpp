// M98 and M97 as Fanuc and Haas have them.
#include <fmt/format.h>

#include <cmath>

#include "controllers/gcode/readers/reading_step.h"

namespace servomill::controllers {
namespace {

constexpr int kNumberDigits = 4;
constexpr double kNumbers = 1e4;

}  // namespace

// M98 P00021001: twice subprogram 1001.
void ReadingStep::subprograms() {
  const BlockWord* P = words.find('P');
  if (P == nullptr || !P->is_literal || P->digits <= kNumberDigits) return;
  if (choose(WordDifference::subprogram_digits, P->column) == 0) return;
  need(ReaderRule::subprogram_repeats, P->column);
  const double repeats = std::floor(P->value / kNumbers);
  const double number = P->value - repeats * kNumbers;
  if (repeats == 0.0) return;
  if (words.has('L')) fail(words.column('L'), "L is not allowed with repetitions in P");
  words.set('P', number);
  words.add('L', repeats, P->column);
}

// G91 X1 M98 P1000 L3: one move, then three calls, for each of which the block is read anew.
void ReadingStep::drop_words_of_earlier_turn() {
  if (!words.has_code('M', 980) && !words.has_code('M', 970)) return;
  for (BlockWord& word : words.all()) {
    const int tenths = word.letter == 'M' ? tenths_of(word.value) : -1;
    const bool is_of_call =
        word.letter == 'P' || word.letter == 'L' || tenths == 980 || tenths == 970;
    if (!is_of_call) words.erase(word);
  }
}

// G0 X1 M98 P1000: the move, then the call.
void ReadingStep::call_behind_words() {
  BlockWord* code = words.code('M', 980);
  if (code == nullptr) return;
  if (!words.has('P')) fail(code->column, "M98 requires a P word (subprogram number)");
  need(ReaderRule::call_with_words, code->column);
  std::string call = fmt::format("M98 P{}", words['P']);
  if (words.has('L')) call += fmt::format(" L{}", words['L']);
  behind.push_back(std::move(call));
  words.erase(*code);
  words.erase('P');
  words.erase('L');
}

void ReadingStep::local_call() {
  BlockWord* code = words.code('M', 970);
  if (code == nullptr) return;
  need(ReaderRule::local_subprogram, code->column);
  if (!words.has('P')) fail(code->column, "M97 requires a P word (block number)");
  LocalCall call;
  call.block_number = static_cast<int>(std::lround(words['P']));
  call.repeats = words.has('L') ? static_cast<int>(std::lround(words['L'])) : 1;
  call.column = code->column;
  if (call.repeats < 1) fail(words.column('L'), "L must be at least 1");
  reading_.local_call_ = call;
  words.erase(*code);
  words.erase('P');
  words.erase('L');
}

}  // namespace servomill::controllers

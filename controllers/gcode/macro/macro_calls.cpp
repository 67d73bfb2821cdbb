// Calls in custom macro B: G65, G66 and G67, M97 and M98, and M99.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "controllers/gcode/macro/macro_source.h"

namespace servomill::controllers::macro {
namespace {

constexpr std::size_t kMaxCalls = 9;      // in each other, as for other programs
constexpr std::ptrdiff_t kMaxMacros = 4;  // of G65 and G66. Fanuc B-63684EN/01 p. 278

MacroWord* find_code(std::vector<MacroWord>& words, char letter, int tenths) {
  for (MacroWord& word : words) {
    if (word.letter == letter && word.tenths() == tenths) return &word;
  }
  return nullptr;
}

bool moves(const std::vector<MacroWord>& words) {
  constexpr std::string_view kAxes = "XYZABCUVW";
  constexpr std::array kTakers = {40, 100, 500, 510, 520, 680, 920, 501, 511};
  const bool has_taker = std::any_of(words.begin(), words.end(), [&](const MacroWord& word) {
    return word.letter == 'G' &&
           std::find(kTakers.begin(), kTakers.end(), word.tenths()) != kTakers.end();
  });
  return !has_taker && std::any_of(words.begin(), words.end(), [&](const MacroWord& word) {
    return kAxes.find(word.letter) != std::string_view::npos && word.value && !word.is_erased;
  });
}

}  // namespace

void MacroSource::call_codes(std::vector<MacroWord>& words, const WordUnits& units) {
  if (MacroWord* code = find_code(words, 'G', 661)) {
    refuse(code->column(), "G66.1, a call in every block, is not supported; use G66 or G65");
  }
  for (const int tenths : {650, 660}) {
    const MacroWord* code = find_code(words, 'G', tenths);
    if (code == nullptr) continue;
    reading_.apply(tenths == 650 ? ReaderRule::macro_call : ReaderRule::modal_macro_call,
                   here(code->column()));
    MacroCall call = macro_call(words, *code, context(), units);
    return tenths == 650 ? begin_call(std::move(call)) : begin_modal(std::move(call));
  }
  if (MacroWord* code = find_code(words, 'G', 670)) end_modal(*code);
  for (const int tenths : {970, 980}) {
    MacroWord* code = find_code(words, 'M', tenths);
    if (code == nullptr) continue;
    MacroCall call = subprogram_call(words, *code, context());
    emit_words(words, units);
    after_ = [this, call] { begin_call(call); };
    return;
  }
  MacroWord* code = find_code(words, 'M', 990);
  if (code == nullptr) return emit_words(words, units);
  std::optional<long> block;
  for (MacroWord& word : words) {
    if (word.letter != 'P' || !word.value) continue;
    block = std::lround(std::clamp(*word.value, -1.0, 1e8));
    word.is_erased = true;
  }
  if (calls_.empty() && !block) return emit_words(words, units);  // the end of the program
  code->is_erased = true;
  emit_words(words, units);
  after_ = [this, block, column = code->column()] { end_call(block, column); };
}

// ------------------------------------------------------------------------------------ modal calls

void MacroSource::begin_modal(MacroCall call) {
  if (!calls_.empty()) {
    refuse(call.column,
           "G66 within a called program: it is undocumented how long it remains active; move it to "
           "the main program");
  }
  modals_.push_back(std::move(call));
}

void MacroSource::end_modal(MacroWord& code) {
  reading_.apply(ReaderRule::modal_macro_call, here(code.column()));
  if (!calls_.empty()) {
    refuse(code.column(),
           "G67 is not supported within a called program; move it to the main program");
  }
  code.is_erased = true;
  if (!modals_.empty()) modals_.pop_back();
}

// Behind a block that moves. Within the program of a G66 the one before it is called.
// Source: Mitsubishi M700V, Programming manual, 13.5 (modal call A, duplicated); Fanuc from memory.
void MacroSource::call_modal(const std::vector<MacroWord>& words) {
  if (modals_.empty() || !moves(words)) return;
  std::size_t count = modals_.size();
  if (!calls_.empty()) {
    if (!calls_.back().modal) {
      refuse(static_cast<int>(line_.begin) + 1,
             "a move in a program called while G66 is active: it is undocumented whether it calls "
             "again; program G67 before the call");
    }
    count = *calls_.back().modal;
  }
  if (count == 0) return;
  after_ = [this, count, column = static_cast<int>(line_.begin) + 1] {
    MacroCall call = modals_[count - 1];
    call.column = column;  // of the block that calls, not of G66
    begin_call(std::move(call), count - 1);
  };
}

// ------------------------------------------------------------------------------------------ calls

void MacroSource::check_depth(const MacroCall& call) {
  const auto macros = std::count_if(calls_.begin(), calls_.end(), [](const RunningCall& one) {
    return one.call.locals.has_value();
  });
  if (call.locals && macros >= kMaxMacros && reading_.reader() == Reader::fanuc) {
    refuse(call.column, fmt::format("macro calls nested deeper than {}", kMaxMacros));
  }
  if (calls_.size() >= kMaxCalls) {
    refuse(call.column, fmt::format("program calls nested deeper than {}", kMaxCalls));
  }
}

// From the text that calls on, then the other files that are known, then a file of its name.
bool MacroSource::find_program(long number) {
  for (std::size_t k = 0; k < files_.size(); ++k) {
    const std::size_t file = (file_ + k) % files_.size();
    const auto mark = files_[file].program(number);
    if (!mark) continue;
    file_ = file;
    text().go_to(*mark);
    return true;
  }
  const std::string name = fmt::format("{}", number);
  std::optional<ProgramText> found = subroutine_file_ ? subroutine_file_(name) : std::nullopt;
  if (!found) return false;
  if (!found->file().ends_with(".ngc")) reading_.apply(ReaderRule::subprogram_file, here(0));
  files_.emplace_back(std::move(*found), skips_optional_);
  file_ = files_.size() - 1;
  if (const auto mark = files_.back().program(number)) text().go_to(*mark);
  return true;
}

void MacroSource::begin_call(MacroCall call, std::optional<std::size_t> modal) {
  check_depth(call);
  count_jump();
  RunningCall running;
  running.return_file = file_;
  running.return_to = text().mark();
  running.line = text().number();
  running.modal = modal;
  const int column = call.column;
  if (call.is_block) {
    const auto mark = places().block(call.number);
    if (!mark) refuse(column, fmt::format("M97 P{0}: block N{0} not found", call.number));
    text().go_to(*mark);
  } else if (!find_program(call.number)) {
    refuse(column,
           fmt::format("program O{0} not found in this file, nor a file {0}.ngc", call.number));
  }
  running.file = file_;
  running.body = text().mark();
  if (call.locals) variables_.enter(*call.locals);
  running.call = std::move(call);
  calls_.push_back(std::move(running));
}

// With L the program runs again. The arguments are set before its first turn only.
// Source: Haas 96-8000, June 1999, p. 365; what Fanuc does is not documented.
bool MacroSource::turn_again(RunningCall& running) {
  if (--running.call.turns <= 0) return false;
  const bool has_changed = running.call.locals && variables_.locals() != *running.call.locals;
  if (has_changed && reading_.reader() != Reader::haas) {
    reading_.fail(here(0),
                  "the program changes its local variables and L calls it again: controls differ "
                  "in whether the values are kept; use a WHILE loop");
  }
  count_jump();
  file_ = running.file;
  text().go_to(running.body);
  return true;
}

// M99, and M99 P: to a block of the program that called (Fanuc) or of this one (Haas).
void MacroSource::end_call(std::optional<long> block, int column) {
  const Place place = here(column);
  if (calls_.empty()) return jump(*block, place, "this program");
  if (block && reading_.choose(WordDifference::return_block, place) == 1) {
    return jump(*block, place, "this program");
  }
  if (!block && turn_again(calls_.back())) return;
  const RunningCall running = std::move(calls_.back());
  calls_.pop_back();
  if (running.call.locals) {
    const Locals locals = variables_.leave();
    // set in the block of G66, and not again. Source: Fanuc B-63944EN, modal call (from memory)
    if (running.modal && *running.modal < modals_.size()) modals_[*running.modal].locals = locals;
  }
  file_ = running.return_file;
  text().go_to(running.return_to);
  if (block) jump(*block, place, "the calling program");
}

}  // namespace servomill::controllers::macro

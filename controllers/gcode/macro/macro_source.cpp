#include "controllers/gcode/macro/macro_source.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <utility>

namespace servomill::controllers::macro {
namespace {

// P of these is no dwell.
constexpr std::array kOtherP = {50, 51, 80, 100, 300, 541, 1540, 1870};

bool has_code(const std::vector<MacroWord>& words, char letter, int tenths) {
  return std::any_of(words.begin(), words.end(), [&](const MacroWord& word) {
    return word.letter == letter && word.tenths() == tenths;
  });
}

}  // namespace

MacroSource::MacroSource(ProgramText text, const ProgramSetup& setup,
                         std::shared_ptr<const ControlState> control)
    : subroutine_file_(setup.subroutine_file),
      skips_optional_(setup.block_delete),
      most_jumps_(setup.most_jumps),
      control_(std::move(control)),
      reading_(setup.reader, setup.decimal_point, setup.is_trial),
      variables_(reading_, setup.parameters, control_) {
  files_.emplace_back(std::move(text), skips_optional_);
}

bool MacroSource::next(std::string& line, Place& place) {
  try {
    has_line_ = false;
    while (!has_line_) {
      if (!step()) return false;
    }
  } catch (const InputError& error) {
    if (calls_.empty()) throw;
    Fault fault = error.faults().front();
    fault.message += call_stack();
    throw InputError({fault});
  }
  line = out_.text();
  place = line_place_;
  return true;
}

bool MacroSource::step() {
  if (!more_.empty()) {
    emit(std::move(more_.front()));
    more_.pop_front();
    return true;
  }
  if (after_) {
    std::exchange(after_, nullptr)();
    return true;
  }
  if (has_ended_) return false;
  std::string_view next;
  if (!text().next(next)) return end_of_text();
  text_ = next;
  if (!text_.empty() && text_.back() == '\r') text_.pop_back();
  if (jumps_ > 0) ++lines_;
  read_line(text_, line_);
  line_place_ = here(0);
  if (line_.is_optional && skips_optional_) {
    emit_as_written();
  } else {
    is_behind_then_ = false;
    run_statement(line_.statement, line_.begin);
  }
  return true;
}

// "; in O9010, called in part.nc:12" for every call that is under way.
std::string MacroSource::call_stack() const {
  std::string out;
  for (auto one = calls_.rbegin(); one != calls_.rend(); ++one) {
    out += fmt::format("{} {}{}, called in {}:{}", out.empty() ? "; in" : ", in",
                       one->call.is_block ? 'N' : 'O', one->call.number,
                       files_[one->return_file].text().file(), one->line);
  }
  return out;
}

void MacroSource::read_words_of_line() {
  const bool is_plain = line_.body.find_first_of("#[", line_.begin) == std::string::npos;
  const bool has_call = has_call_code(line_.body);
  if (is_plain && !has_call && modals_.empty()) return emit_as_written();
  WordUnits units;
  units.is_inch = control_->is_inch && control_->is_inch();
  for (const std::string_view code : {"G65", "G66"}) {
    units.are_arguments = units.are_arguments || line_.body.find(code) != std::string::npos;
  }
  const Expression::Context now = context();
  std::vector<MacroWord> words = read_words(line_.body, line_.begin, now, units);
  if (has_code(words, 'G', 200)) units.is_inch = true;
  if (has_code(words, 'G', 210)) units.is_inch = false;
  if (has_call) return call_codes(words, units);
  emit_words(words, units);
  call_modal(words);
}

void MacroSource::emit_words(std::vector<MacroWord>& words, const WordUnits& units) {
  choose_dwell(words);
  out_.set(text_, words, context(), units);
  has_line_ = out_.has_words() || !line_.comment.empty();
}

// P of G4 and of canned cycles: a whole number of milliseconds where the control has them.
void MacroSource::choose_dwell(std::vector<MacroWord>& words) {
  const bool is_other = std::any_of(kOtherP.begin(), kOtherP.end(),
                                    [&](int tenths) { return has_code(words, 'G', tenths); });
  for (MacroWord& word : words) {
    if (word.letter != 'P' || word.is_literal || !word.value || is_other) continue;
    reading_.choose(WordDifference::variable_dwell, here(word.column()));
    word.value = rounded_to(*word.value, 1.0);
  }
}

void MacroSource::percent() {
  if (calls_.empty()) return emit_as_written();
  if (text().number() > 1) end_of_text();
}

// The number of the program that runs has no effect; another one is the next program.
void MacroSource::program_number() {
  if (!calls_.empty()) {
    if (!calls_.back().call.is_block && text().number() == calls_.back().body.line + 1) return;
  } else if (!std::exchange(has_number_, true)) {
    return emit_as_written();
  }
  refuse(static_cast<int>(line_.begin) + 1,
         calls_.empty() ? "the program runs into the next one; end it with M30 or M2"
                        : "the called program runs into the next one; end it with M99");
}

bool MacroSource::end_of_text() {
  if (calls_.empty()) {
    has_ended_ = true;
    return false;
  }
  has_ended_ = true;
  reading_.refuse({file(), text().number(), 0}, "a called program must end with M99");
}

}  // namespace servomill::controllers::macro

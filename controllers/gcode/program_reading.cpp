// Lines of a program, one after the other: what they are, and the block that runs.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include "controllers/gcode/interpreter_machine.h"
#include "controllers/gcode/other_language.h"

namespace servomill::controllers {
namespace {

constexpr std::string_view kSecondBlock =
    "words after ';': a comment (LinuxCNC, grbl, Mach), or another block (Fanuc, Haas, where ';' "
    "ends a block); write each block on a separate line, or comments in ( )";

}  // namespace

bool Interpreter::Machine::read_block() {
  block_.clear();
  is_rewritten_ = false;
  if (!pending_lines_.empty()) return with_place_of_fault([this] { read_pending_line(); }), true;
  ProgramText& source = text();
  here_ = {text_, source.mark()};
  const bool is_there = source.next(line_);
  const bool is_generated = source.is_generated();
  if (is_generated) {
    for (Fault& one : source.take_warnings()) warnings_.push_back(std::move(one));
    unknowns_ = source.source()->unknowns();
  }
  if (!is_there) return end_of_text(), true;
  if (is_of_other_language()) return read_generated_line(), true;
  if (is_blank(line_)) return true;
  if (flow_.jumps > 0) ++flow_.lines;
  with_place_of_fault([this] { flow_.skip_to ? read_skipped_line() : read_executed_line(); });
  return true;
}

// Faults name the column in the line as written, and the calls that are under way.
template <typename Action>
void Interpreter::Machine::with_place_of_fault(const Action& action) {
  try {
    action();
  } catch (const InputError& error) {
    const LineSource* source = text().source();
    if (flow_.calls.empty() && !is_rewritten_ && source == nullptr) throw;
    Fault fault = error.faults().front();
    if (is_rewritten_) fault.place.column = original_column(fault.place.column);
    if (source != nullptr) {
      fault.place.column = source->original_column(fault.place.column);
      fault.message += source->call_stack();
    }
    if (!flow_.calls.empty()) fault.message += call_stack();
    throw InputError({fault});
  }
}

// A line that another language's block became, as LinuxCNC reads it: faults are at that block, and
// show the line.
void Interpreter::Machine::read_generated_line() {
  const std::size_t before = warnings_.size();
  try {
    reader_.parse(line_, file(), line(), block_);
    texts_[text_].percent.saw_line();
    execute();
  } catch (const InputError& error) {
    throw InputError({file(), line(), text().column()},
                     fmt::format("read as \"{}\": {}", line_, error.faults().front().message));
  }
  for (std::size_t i = before; i < warnings_.size(); ++i) {
    warnings_[i].place.column = text().column();
  }
}

void Interpreter::Machine::read_executed_line() {
  reader_.parse(line_, file(), line(), block_);
  for (const AppliedRule& one : reader_.applied()) tolerates(one.rule, one.column);
  if (block_.percent) return saw_percent();
  if (reader_.corner() && (block_.words.empty() || block_.o_word.flow != Flow::none)) {
    fail(reader_.corner()->column,
         fmt::format("',{}' requires a linear move in its block", reader_.corner()->letter));
  }
  const bool is_strict = setup_.reader == Reader::linuxcnc;
  const bool is_comment = !is_strict && block_.words.empty() && block_.assignments.empty() &&
                          block_.o_word.flow == Flow::none && !block_.deleted;
  if (is_comment && texts_[text_].percent.saw_nothing()) {
    texts_[text_].has_title = true;
    return execute();
  }
  texts_[text_].percent.saw_line();
  if (block_.deleted) return;
  if (!has_warned_of_points_ && setup_.reader == Reader::any &&
      setup_.decimal_point == DecimalPoint::unset) {
    look_for_missing_points();
  }
  if (setup_.reader == Reader::any && !block_.code.empty()) note_other_arithmetic();
  if (const int column = is_strict ? 0 : column_of_second_block(line_); column > 0) {
    if (setup_.reader == Reader::fanuc || setup_.reader == Reader::haas) {
      fail(column, std::string(kSecondBlock));
    }
    if (noted_.insert(std::string(kSecondBlock)).second) warn(column, std::string(kSecondBlock));
  }
  if (reader_.corner()) {
    reading_.round_corner(corner_to_next());
    return read_as_control();
  }
  reading_.round_corner({});
  is_strict || !reading_.concerns(block_, state_) ? execute() : read_as_control();
}

// A block that a control reads in another way than LinuxCNC runs as the lines that say it to
// LinuxCNC.
void Interpreter::Machine::read_as_control() {
  reading_.call_again(flow_.turns_left.back() > 0);
  const bool is_other = reading_.read(line_, file(), block_, state_, [this](const Value& value) {
    return evaluate(value, block_, parameters_, file());
  });
  for (const AppliedRule& one : reading_.applied()) tolerates(one.rule, one.column, one.detail);
  for (const ReadingNote& one : reading_.notes()) {
    if (noted_.insert(one.text).second) warn(one.column, one.text);
  }
  nth_line_ = 0;
  if (is_other) {
    pending_lines_.assign(reading_.lines().begin(), reading_.lines().end());
    return read_pending_line();
  }
  try {
    execute();
  } catch (const InputError&) {
    reading_.roll_back();
    throw;
  }
}

void Interpreter::Machine::read_pending_line() {
  is_rewritten_ = true;
  pending_line_ = std::move(pending_lines_.front());
  pending_lines_.pop_front();
  line_ = pending_line_;
  const std::size_t moves_before = out_.size();
  try {
    reader_.parse(line_, file(), line(), block_);
    execute();
  } catch (const InputError&) {
    pending_lines_.clear();
    reading_.roll_back();
    throw;
  }
  if (!pending_lines_.empty()) ++nth_line_;
  if (!pending_lines_.empty() || !reading_.local_call()) return;
  is_rewritten_ = false;  // its column is that of the program
  try {
    call_block(*reading_.local_call());
  } catch (const InputError&) {  // a block that fails has moved nothing
    reading_.roll_back();
    state_ = before_;
    out_.resize(moves_before);
    throw;
  }
}

int Interpreter::Machine::original_column(int column) const {
  return reading_.original_column(nth_line_, column);
}

void Interpreter::Machine::warn(int column, std::string message) {
  if (is_rewritten_) column = original_column(column);
  if (text().is_generated()) column = text().source()->original_column(column);
  warnings_.push_back({{file(), line(), column}, std::move(message)});
}

// Only the line with the right label ends the skipping; it is then read in full.
void Interpreter::Machine::read_skipped_line() {
  reader_.parse(line_, file(), line(), block_, Parser::Extent::flow_only);
  if (block_.percent) {
    if (!texts_[text_].percent.is_framed() || goes_on_behind_end()) return block_.clear();
    return saw_percent();
  }
  texts_[text_].percent.saw_line();
  if (block_.deleted || !may_end_skipping(block_.o_word)) return block_.clear();
  for (const AppliedRule& one : reader_.applied()) tolerates(one.rule, one.column);
  reader_.parse(line_, file(), line(), block_, Parser::Extent::flow_value);
  execute();
}

bool Interpreter::Machine::may_end_skipping(const OWord& o) const {
  switch (o.flow) {
    case Flow::none:
    case Flow::call:
    case Flow::m98:
    case Flow::m99:
      return false;
    case Flow::unknown:
      return !flow_.defining;  // to be refused
    case Flow::sub:
    case Flow::program:
      return flow_.defining || label_of(o) == *flow_.skip_to;
    case Flow::endsub:
    case Flow::return_:
      return label_of(o) == *flow_.skip_to;
    default:
      return !flow_.defining && label_of(o) == *flow_.skip_to;
  }
}

// Checks that the reader has the rule, and reports its first use.
bool Interpreter::Machine::tolerates(ReaderRule rule, int column, const std::string& detail) {
  if (!has_rule(setup_.reader, rule)) return false;
  if (!tolerated_.insert(rule).second) return true;
  const ReaderRuleEntry& entry = reader_rules()[static_cast<std::size_t>(rule)];
  // what LinuxCNC takes does not matter to a program in another language
  warn(column, (is_of_other_language() ? fmt::format("{}: {}", entry.found, entry.reading)
                                       : sentence(rule)) +
                   detail);
  return true;
}

// "; in O<hole>, called in part.ngc:12" for every call that is under way; equal ones in a row once.
std::string Interpreter::Machine::call_stack() const {
  std::string text, last;
  int repeated = 1;
  const auto end_of_last = [&] {
    if (!last.empty()) text += last + (repeated > 1 ? fmt::format(" ({} times)", repeated) : "");
  };
  for (auto call = flow_.calls.rbegin(); call != flow_.calls.rend(); ++call) {
    const std::string& from = texts_[call->return_to.text].lines.file();
    std::string one =
        fmt::format("{} O<{}>, called in {}:{}", ", in", call->name, from, call->line);
    if (one == last) {
      ++repeated;
      continue;
    }
    end_of_last();
    last = std::move(one);
    repeated = 1;
  }
  end_of_last();
  return text.empty() ? text : ";" + text.substr(1);
}

void Interpreter::Machine::execute() {
  before_ = state_;
  const std::size_t moves_before = out_.size();
  try {
    block_.o_word.flow == Flow::none ? run_block() : run_flow_of_reader();
  } catch (const InputError&) {
    state_ = before_;
    parameters_.roll_back();
    out_.erase(out_.begin() + static_cast<std::ptrdiff_t>(moves_before), out_.end());
    throw;
  }
  parameters_.commit();
}

void Interpreter::Machine::run_flow_of_reader() {
  const Flow flow = block_.o_word.flow;
  const bool is_of_all = flow == Flow::program || flow == Flow::m98 || flow == Flow::m99;
  const bool has_o_words = setup_.reader == Reader::any || setup_.reader == Reader::linuxcnc;
  if (!is_of_all && !has_o_words) {
    fail(block_.o_word.column, fmt::format("O-words with keywords are not supported by {}",
                                           kReaders[static_cast<std::size_t>(setup_.reader)]));
  }
  try {
    run_flow();
  } catch (const InputError&) {
    if (setup_.is_trial) throw Undetermined();
    throw;
  }
}

void Interpreter::Machine::run_block() {
  const bool has_vectors = state_.tool_control == ToolControl::tool_axis;
  resolve(block_, parameters_, state_.motion, has_vectors, file(), request_);
  if (!setup_.takes_five_axis_codes) refuse_codes_beyond_linuxcnc();
  assign_parameters();
  const std::uint64_t asked =
      kAlways | request_.letters | std::uint64_t{request_.groups} << kLetters;
  try {
    for (const Step& step : kSteps) {
      if ((step.due & asked) != 0) (this->*step.run)();
    }
  } catch (const InputError&) {
    if (setup_.is_trial) throw Undetermined();
    throw;
  }
}

std::vector<Move> Interpreter::Machine::rest() {
  out_.erase(out_.begin(), out_.begin() + static_cast<std::ptrdiff_t>(given_));
  given_ = 0;
  while (!ended_ && read_block()) {
  }
  return std::exchange(out_, {});
}

std::optional<ExecutedBlock> Interpreter::Machine::next_block() {
  clear_output();
  if (ended_) return std::nullopt;
  reader_.keep_pieces(true);
  request_.clear();
  new_numbers_.clear();
  const std::size_t read_from = text_;
  ExecutedBlock out;
  out.call_depth = static_cast<int>(flow_.calls.size());
  read_block();
  if (text().is_generated()) out.call_depth += text().source()->call_depth();
  out.text = line_;
  out.moves = out_;
  out.file = &texts_[read_from].lines.file();
  const bool is_generated = texts_[read_from].lines.is_generated();  // many lines of one block
  out.line = is_generated ? texts_[read_from].lines.number() : here_.mark.line + 1;
  out.is_repeated = out.line + (is_of_other_language() ? 1 : 0) <= texts_[read_from].last_line;
  texts_[read_from].last_line = std::max(texts_[read_from].last_line, out.line);
  out.state = &state_;
  out.frame = &reading_.frame();
  out.unknown_moves = unknowns_.motion;
  if (block_.pieces.empty()) return out;
  out.block = &block_;
  const bool has_words = block_.o_word.flow == Flow::none && !block_.percent && !block_.deleted;
  if (has_words) out.request = &request_;
  out.assigned = new_numbers_;
  return out;
}

// All right-hand sides are read before the first parameter changes.
void Interpreter::Machine::assign_parameters() {
  if (block_.assignments.empty()) return;
  new_numbers_.clear();
  for (Assignment& a : block_.assignments) {
    const double value = evaluate(a.value, block_, parameters_, file());
    int number = 0;
    if (a.name < 0) {
      const double index = evaluate(a.index, block_, parameters_, file());
      number = parameter_number(index, {file(), block_.line, a.column});
      if (parameter::is_read_only(number)) {
        fail(a.column, fmt::format("parameter #{} is read-only", number));
      }
    }
    new_numbers_.emplace_back(number, value);
  }
  for (std::size_t i = 0; i < new_numbers_.size(); ++i) {
    const Assignment& a = block_.assignments[i];
    if (a.name < 0) {
      parameters_.set(new_numbers_[i].first, new_numbers_[i].second);
      if (setup_.reader == Reader::any) assigned_.insert(new_numbers_[i].first);
      continue;
    }
    const std::string& name = block_.names[static_cast<std::size_t>(a.name)];
    if (system_name(name)) fail(a.column, fmt::format("parameter #<{}> is read-only", name));
    parameters_.set(name, new_numbers_[i].second);
  }
}

}  // namespace servomill::controllers

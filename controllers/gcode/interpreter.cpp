#include "controllers/gcode/interpreter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "controllers/conversational/conversational.h"
#include "controllers/gcode/interpreter_machine.h"
#include "controllers/gcode/message_text.h"
#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

constexpr std::string_view kMisplacedPercent =
    "'%' ends a program only if another '%' is its first line";
constexpr std::string_view kPercentInside =
    "Fanuc ends the program at this '%', other controls go on behind it; choose with --reader";
constexpr std::string_view kNoEnd = "the program ends without M2, M30 or a closing '%'";

}  // namespace

std::array<AxisWords, 9> ProgramSetup::zero_offsets() {
  std::array<AxisWords, 9> offsets;
  offsets.fill(AxisWords::Zero());
  return offsets;
}

const std::array<Interpreter::Machine::Step, 21> Interpreter::Machine::kSteps = {{
    {&Machine::message, kAlways},
    {&Machine::feed_mode, bit(Group::g_feed_mode)},
    {&Machine::feed, bit('F')},
    {&Machine::spindle_speed, bit('S')},
    {&Machine::select_tool, bit('T')},
    {&Machine::change_tool, bit(Group::m_tool)},
    {&Machine::spindle, bit(Group::m_spindle)},
    {&Machine::coolant, bit(Group::m_coolant)},
    {&Machine::override_switches, bit(Group::m_override)},
    {&Machine::dwell, bit(Group::g_non_modal)},
    {&Machine::plane, bit(Group::g_plane)},
    {&Machine::units, bit(Group::g_units)},
    {&Machine::cutter_compensation, kAlways},
    {&Machine::tool_length, bit(Group::g_tool_length)},
    {&Machine::work_system, bit(Group::g_work_system)},
    {&Machine::work_plane, bit(Group::g_work_plane)},
    {&Machine::path_control, bit(Group::g_path_control)},
    {&Machine::distance,
     bit(Group::g_distance) | bit(Group::g_arc_distance) | bit(Group::g_retract)},
    {&Machine::non_modal, bit(Group::g_non_modal)},
    {&Machine::motion, kAlways},
    {&Machine::stop, bit(Group::m_stop)},
}};

// ------------------------------------------------------------------------------------------ setup

void Interpreter::Machine::set_initial(const std::string& name, double value) {
  const Place place{file(), 0, 0};
  const auto refuse = [&](std::string_view why) {
    throw InputError(place, fmt::format("parameter '{}': {}", name, why));
  };
  if (!std::isfinite(value)) refuse("value must be finite");
  if (name.size() > 3 && name.starts_with("#<") && name.back() == '>') {
    std::string key;
    for (const char c : name.substr(2, name.size() - 3)) {
      if (c != ' ' && c != '\t') key += c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
    }
    if (key.empty()) refuse("name is empty");
    if (parameters_.is_system_name(key)) refuse("is set by the machine");
    parameters_.set(key, value);
    return;
  }
  const bool digits = name.size() > 1 && name.size() < 6 && name[0] == '#' &&
                      name.find_first_not_of("0123456789", 1) == std::string::npos;
  if (!digits) refuse("must be written #123 or #<name>");
  const int number = parameter_number(std::stoi(name.substr(1)), place);
  if (parameter::is_read_only(number)) refuse("is set by the machine");
  parameters_.set(number, value);
}

void Interpreter::Machine::store_setup_offset(int system) {
  const auto k = static_cast<std::size_t>(system - 1);
  const AxisWords& offset = setup_.work_offset[k];
  for (int i = 0; i < kAxisWords; ++i) {
    if (offset[i] == 0.0) continue;  // a parameter may have set it
    parameters_.set(parameter::work_offset(system) + i, in_parameter_unit(i, offset[i]));
  }
  if (setup_.work_rotation[k] != 0.0) {
    parameters_.set(parameter::work_rotation(system), setup_.work_rotation[k] / deg);
  }
}

// ---------------------------------------------------------------------------------------- reading

bool Interpreter::Machine::read_block() {
  here_ = {text_, text().mark()};
  block_.clear();
  const bool is_there = text().next(line_);
  for (Fault& one : text().take_warnings()) warnings_.push_back(std::move(one));
  if (!is_there) return end_of_text(), true;
  if (text().is_generated()) return read_generated_line(), true;
  if (is_blank(line_)) return true;
  if (flow_.jumps > 0) ++flow_.lines;
  try {
    flow_.skip_to ? read_skipped_line() : read_executed_line();
  } catch (const InputError& error) {
    if (flow_.calls.empty()) throw;
    Fault fault = error.faults().front();
    fault.message += call_stack();
    throw InputError({fault});
  }
  return true;
}

// A line that another language's block became: faults are at that block, and show the line.
void Interpreter::Machine::read_generated_line() {
  const std::size_t before = warnings_.size();
  try {
    read_executed_line();
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
  texts_[text_].percent.saw_line();
  if (!block_.deleted) execute();
}

// Only the line with the right label ends the skipping; it is then read in full.
void Interpreter::Machine::read_skipped_line() {
  reader_.parse(line_, file(), line(), block_, Parser::Extent::flow_only);
  if (block_.percent) {
    if (!texts_[text_].percent.is_framed()) return block_.clear();
    return saw_percent();
  }
  texts_[text_].percent.saw_line();
  if (block_.deleted || !may_end_skipping(block_.o_word)) return block_.clear();
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

void Interpreter::Machine::saw_percent() {
  const Percent meaning = texts_[text_].percent.saw_percent();
  if (meaning == Percent::misplaced) {
    if (!has_rule(setup_.reader, ReaderRule::percent_at_end) || flow_.skip_to || text_ != 0) {
      fail(1, std::string(kMisplacedPercent));
    }
    if (setup_.reader == Reader::any && has_more_words()) fail(1, std::string(kPercentInside));
    return run_end(ReaderRule::percent_at_end);
  }
  if (meaning != Percent::end) return;
  if (flow_.skip_to || text_ != 0) fail_at_end();
  ended_ = true;
}

// The text ends although the program does not.
void Interpreter::Machine::end_of_text() {
  const bool is_empty = texts_[0].percent.saw_nothing();
  const bool is_main = !is_empty && !flow_.skip_to && flow_.calls.empty() && text_ == 0;
  if (!is_main || !has_rule(setup_.reader, ReaderRule::end_of_text)) fail_at_end();
  run_end(ReaderRule::end_of_text);
}

// M2 in place of a line, so that writers of programs see it.
void Interpreter::Machine::run_end(ReaderRule rule) {
  tolerates(rule, 0);
  line_ = "M2";
  reader_.parse(line_, file(), line(), block_);
  execute();
}

bool Interpreter::Machine::has_more_words() {
  const ProgramText::Mark here = text().mark();
  bool found = false;
  for (std::string_view next; !found && text().next(next);) {
    found = next.find_first_not_of(" \t\r%") != std::string_view::npos;
  }
  text().go_to(here);
  return found;
}

// Checks that the reader has the rule, and reports its first use.
bool Interpreter::Machine::tolerates(ReaderRule rule, int column) {
  if (!has_rule(setup_.reader, rule)) return false;
  if (tolerated_.insert(rule).second) warn(column, sentence(rule));
  return true;
}

void Interpreter::Machine::fail_at_end() {
  ended_ = true;
  std::string message(kNoEnd);
  if (flow_.skips_to_sub) {
    message = fmt::format("no subroutine O<{0}> up to here, which line {1} calls{2}",
                          *flow_.skip_to, flow_.skip_from,
                          text_ == flow_.calls.back().return_to.text
                              ? fmt::format(", and no file {}.ngc", *flow_.skip_to)
                              : "");
    flow_.calls.pop_back();  // it has not begun
  } else if (flow_.skip_to) {
    const std::string label = flow_.skip_to->substr(flow_.skip_to->find('#') + 1);
    message =
        fmt::format("the program ends while it skips to O{} from line {}", label, flow_.skip_from);
  }
  fail(0, message + call_stack());
}

// "; in O<hole>, called in part.ngc:12" for every call that is under way.
std::string Interpreter::Machine::call_stack() const {
  std::string text;
  for (auto call = flow_.calls.rbegin(); call != flow_.calls.rend(); ++call) {
    const std::string& from = texts_[call->return_to.text].lines.file();
    text += fmt::format("{} O<{}>, called in {}:{}", text.empty() ? "; in" : ", in", call->name,
                        from, call->line);
  }
  return text;
}

void Interpreter::Machine::execute() {
  before_ = state_;
  const std::size_t moves_before = out_.size();
  try {
    block_.o_word.flow == Flow::none ? run_block() : run_flow();
  } catch (const InputError&) {
    state_ = before_;
    parameters_.roll_back();
    out_.erase(out_.begin() + static_cast<std::ptrdiff_t>(moves_before), out_.end());
    throw;
  }
  parameters_.commit();
}

void Interpreter::Machine::run_block() {
  const bool has_vectors = state_.tool_control == ToolControl::tool_axis;
  resolve(block_, parameters_, state_.motion, has_vectors, file(), request_);
  assign_parameters();
  const std::uint64_t asked =
      kAlways | request_.letters | std::uint64_t{request_.groups} << kLetters;
  for (const Step& step : kSteps) {
    if ((step.due & asked) != 0) (this->*step.run)();
  }
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
  out.text = line_;
  out.moves = out_;
  out.file = &texts_[read_from].lines.file();
  const bool is_generated = texts_[read_from].lines.is_generated();  // many lines of one block
  out.line = is_generated ? texts_[read_from].lines.number() : here_.mark.line + 1;
  out.is_repeated = out.line + (is_generated ? 1 : 0) <= texts_[read_from].last_line;
  texts_[read_from].last_line = std::max(texts_[read_from].last_line, out.line);
  out.state = &state_;
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
      continue;
    }
    const std::string& name = block_.names[static_cast<std::size_t>(a.name)];
    if (system_name(name)) fail(a.column, fmt::format("parameter #<{}> is read-only", name));
    parameters_.set(name, new_numbers_[i].second);
  }
}

int Interpreter::Machine::integer(char letter, double tolerance) const {
  const double value = request_[letter];
  const double nearest = std::round(value);
  if (!(std::abs(value - nearest) <= tolerance) || std::abs(nearest) > 1e9) {
    fail_at(letter, fmt::format("{}{}; must be an integer", letter, value));
  }
  return static_cast<int>(nearest);
}

// ---------------------------------------------------------------- speed, feed, tool and the like

void Interpreter::Machine::message() {
  const Comment& comment = block_.message;
  const bool is_silent =
      comment.kind == CommentKind::plain ||
      (comment.kind == CommentKind::debug && parameters_.get(parameter::kDebug) == 0.0) ||
      (comment.kind == CommentKind::print && is_blank(comment.text));
  if (is_silent) return;
  Move& move = emit(MoveKind::message);
  is_printing_ = true;
  move.text =
      comment.kind == CommentKind::message ? comment.text : message_text(comment.text, parameters_);
  is_printing_ = false;
  move.text = trimmed(move.text);
  move.number = comment.kind == CommentKind::print ? kPrintMessage : 0;
}

void Interpreter::Machine::feed_mode() {
  const int code = request().code(Group::g_feed_mode);
  if (code < 0) return;
  set_feed_mode(code == 930   ? FeedMode::inverse_time
                : code == 940 ? FeedMode::units_per_minute
                              : FeedMode::units_per_revolution);
}

void Interpreter::Machine::set_feed_mode(FeedMode mode) {
  state_.feed_mode = mode;
  state_.feed_linear = state_.feed_rotary = 0.0;  // as LinuxCNC: a feed does not outlive its mode
}

void Interpreter::Machine::feed() {
  if (!request().has('F')) return;
  const double F = request()['F'];
  if (F < 0.0) fail_at('F', fmt::format("F{}; must be >= 0", F));
  set_feed(F);
}

void Interpreter::Machine::set_feed(double F) {
  if (state_.feed_mode == FeedMode::inverse_time) return;  // belongs to its block only
  const double per = state_.feed_mode == FeedMode::units_per_revolution ? 1.0 : minute;
  state_.feed_linear = F * state_.unit / per;
  state_.feed_rotary = F * deg / per;
}

void Interpreter::Machine::emit_spindle() {
  Move& move = emit(MoveKind::spindle);
  move.direction = state_.spindle_direction;
  move.value = state_.spindle_speed;
}

void Interpreter::Machine::spindle_speed() {
  if (!request().has('S')) return;
  const double S = request()['S'];
  if (S < 0.0) fail_at('S', fmt::format("S{}; must be >= 0", S));
  state_.spindle_speed = S * rpm;
  emit_spindle();
}

const ToolEntry& Interpreter::Machine::tool_named(char letter, int number) const {
  static const ToolEntry no_tool;
  if (number == 0) return no_tool;
  const ToolEntry* tool = setup_.tools.find(number);
  if (tool == nullptr) {
    if (setup_.tools.empty() && has_rule(setup_.reader, ReaderRule::tool_without_table)) {
      fail_at(letter,
              fmt::format("{0}{1}: length and diameter of tool {1} are unknown; pass a tool "
                          "table with --tools",
                          letter, number));
    }
    fail_at(letter,
            setup_.tools.empty()
                ? fmt::format("{}{}: no tool is known; a tool table says them", letter, number)
                : fmt::format("{}{}: no such tool in the tool table of {} tools", letter, number,
                              setup_.tools.size()));
  }
  return *tool;
}

void Interpreter::Machine::select_tool() {
  if (!request().has('T')) return;
  const int number = integer('T');
  if (number < 0) fail_at('T', fmt::format("T{}; must be >= 0", number));
  // a table that lacks the number shows a slip
  const bool is_unknown = number != 0 && setup_.tools.empty();
  if (!is_unknown || !tolerates(ReaderRule::tool_without_table, request().word('T').column)) {
    tool_named('T', number);
  }
  state_.selected_tool = number;
}

void Interpreter::Machine::change_tool() {
  if (request().code(Group::m_tool) < 0) return;
  if (state_.spindle_direction != 0) {
    state_.spindle_direction = 0;
    emit_spindle();
  }
  if (state_.selected_tool >= 0) state_.tool = state_.selected_tool;
  if (const std::optional<AxisWords> at =
          std::exchange(state_.compensation.left_at, std::nullopt)) {
    state_.position = state_.from_account(*at);
  }
  emit(MoveKind::tool).number = state_.tool;
}

void Interpreter::Machine::spindle() {
  const int code = request().code(Group::m_spindle);
  if (code < 0) return;
  if (code > 50) return saved_modes();
  state_.spindle_direction = code == 30 ? 1 : code == 40 ? -1 : 0;
  emit_spindle();
}

void Interpreter::Machine::coolant() {
  const int code = request().code(Group::m_coolant);
  if (code < 0) return;
  if (code == 70) state_.coolant |= kMist;
  if (code == 80) state_.coolant |= kFlood;
  if (code == 90) state_.coolant = 0;
  emit(MoveKind::coolant).number = state_.coolant;
}

// P of M50 ... M53: 0 switches off, anything else and nothing on.
bool Interpreter::Machine::is_switch_on() const {
  return !request().has('P') || request()['P'] != 0.0;
}

void Interpreter::Machine::override_switches() {
  switch (request().code(Group::m_override)) {
    case 480:
    case 490:
      state_.feed_override = state_.speed_override = request().code(Group::m_override) == 480;
      return;
    case 500:
      state_.feed_override = is_switch_on();
      return;
    case 510:
      state_.speed_override = is_switch_on();
      return;
    case 520:
      state_.adaptive_feed = is_switch_on();
      return;
    case 530:
      state_.feed_hold = is_switch_on();
      return;
    default:
      return;
  }
}

// ------------------------------------------------------------------------------------ modal codes

void Interpreter::Machine::dwell() {
  if (request().code(Group::g_non_modal) != 40) return;
  const int column = request().of(Group::g_non_modal).column;
  if (!request().has('P')) fail(column, "G4 needs a P word (seconds)");
  const double P = request()['P'];
  if (P < 0.0) fail_at('P', fmt::format("G4 P{}; must be >= 0", P));
  const int motion_code = request().code(Group::g_motion);
  if (motion_code == 20 || motion_code == 30) {
    fail(column, "G4 and an arc in one block: both use the P word");
  }
  emit(MoveKind::dwell).value = P;
}

void Interpreter::Machine::plane() {
  const int code = request().code(Group::g_plane);
  if (code < 0) return;
  state_.normal_axis = code < 180 ? 2 : code < 190 ? 1 : 0;
  state_.is_uvw_plane = code % 10 != 0;
}

void Interpreter::Machine::units() {
  const int code = request().code(Group::g_units);
  if (code >= 0) state_.set_unit(code == 200 ? inch : mm);
}

void Interpreter::Machine::tool_length() {
  const int code = request().code(Group::g_tool_length);
  if (code < 0) return;
  const int column = request().of(Group::g_tool_length).column;
  const AxisWords machine = machine_now(column);
  if (code == 490) {
    state_.set_tool_offset(AxisWords::Zero());
    state_.tool_offset_number = 0;
  } else if (code == 431) {
    AxisWords offset = state_.tool_account;
    for (int i = 0; i < kAxisWords; ++i) {
      if (has_axis(i)) offset[i] = axis_word(i);
    }
    state_.set_tool_offset(offset);
    state_.tool_offset_number = kOtherToolOffset;
  } else {
    set_table_offset(code == 432);
  }
  const ToolControl before = std::exchange(state_.tool_control, tool_control_of(code));
  if (before != state_.tool_control) state_.tool_axis.setZero();
  const ToolEntry* at_start = tools_at_start_.find(state_.tool_offset_number);
  if (state_.controls_tip() && at_start != nullptr &&
      at_start->offset != tool_named('H', state_.tool_offset_number).offset) {
    fail(column, fmt::format("{}: G10 has changed T{}; tool-centre-point control and tilted planes "
                             "need the offset of the tool table",
                             code_name('G', code), state_.tool_offset_number));
  }
  if (state_.plane && state_.tool_offset_number == kOtherToolOffset) {
    fail(column, fmt::format("{} in a tilted work plane; use G43 H", code_name('G', code)));
  }
  stand_at(machine, column);
}

// G43 and G43.2
void Interpreter::Machine::set_table_offset(bool is_added) {
  const bool has_H = request().has('H');
  if (is_added && !has_H) fail(request().of(Group::g_tool_length).column, "G43.2 needs an H word");
  int number = has_H ? integer('H') : state_.tool;
  if (number == 0) number = state_.tool;
  const AxisWords& offset = tool_named(has_H ? 'H' : 'T', number).offset;
  state_.set_tool_offset(is_added ? AxisWords(state_.tool_account + offset) : offset);
  state_.tool_offset_number = is_added ? kOtherToolOffset : number;
}

void Interpreter::Machine::load_work_system(int system) {
  const AxisWords machine = state_.to_account(state_.position);
  state_.work_system = system;
  for (int i = 0; i < kAxisWords; ++i) {
    state_.work_offset[i] =
        from_parameter_unit(i, parameters_.get(parameter::work_offset(system) + i));
  }
  state_.set_rotation(parameters_.get(parameter::work_rotation(system)) * deg);
  parameters_.set(parameter::kWorkSystem, system);
  state_.position = state_.from_account(machine);
}

void Interpreter::Machine::work_system() {
  const int code = request().code(Group::g_work_system);
  if (code < 0) return;
  const int system = code <= 590 ? (code - 530) / 10 : 6 + code - 590;
  if (system != state_.work_system) load_work_system(system);
}

void Interpreter::Machine::path_control() {
  const int code = request().code(Group::g_path_control);
  if (code < 0) return;
  state_.path_mode = code == 610   ? PathMode::exact_path
                     : code == 611 ? PathMode::exact_stop
                                   : PathMode::continuous;
  state_.path_tolerance = 0.0;
  if (code != 640) return;
  for (const char word : {'P', 'Q'}) {
    const double value = request()[word];
    if (value < 0.0) {
      warn(request().word(word).column, fmt::format("G64 {}{} counts as 0", word, value));
    }
  }
  state_.path_tolerance = std::max(request()['P'], 0.0) * state_.unit;
}

void Interpreter::Machine::distance() {
  const int code = request().code(Group::g_distance);
  if (code >= 0) state_.is_incremental = code == 910;
  const int arc_code = request().code(Group::g_arc_distance);
  if (arc_code >= 0) state_.is_centre_absolute = arc_code == 901;
  const int retract_code = request().code(Group::g_retract);
  if (retract_code >= 0) state_.retracts_to_r = retract_code == 990;
}

void Interpreter::Machine::stop() {
  const int code = request().code(Group::m_stop);
  if (code < 0) return;
  if (code == 990 && !flow_.calls.empty()) {
    fail(request().of(Group::m_stop).column, "M99 of a subprogram must stand alone in its block");
  }
  end_queue_at(state_.in_plane(state_.position));
  state_.compensation.begin.reset();
  if (code == 0 || code == 10 || code == 600) {
    emit(MoveKind::stop).number = code / 10;
    return;
  }
  if (state_.spindle_direction != 0) {
    state_.spindle_direction = 0;
    emit_spindle();
  }
  if (state_.coolant != 0) {
    state_.coolant = 0;
    emit(MoveKind::coolant).number = 0;
  }
  emit(MoveKind::end);
  ended_ = true;
}

// ------------------------------------------------------------------------------------- public API

Interpreter::Interpreter(ProgramText text, ProgramSetup setup) {
  if (conversational::is_conversational(text, setup.reader)) {
    text = conversational::as_gcode(std::move(text), setup);
  }
  machine_ = std::make_unique<Machine>(std::move(text), std::move(setup));
}
Interpreter::Interpreter(std::string text, std::string file, ProgramSetup setup)
    : Interpreter(ProgramText::of_text(std::move(text), std::move(file)), std::move(setup)) {}
Interpreter::~Interpreter() = default;
Interpreter::Interpreter(Interpreter&&) noexcept = default;
Interpreter& Interpreter::operator=(Interpreter&&) noexcept = default;

const Move* Interpreter::next() { return machine_->next(); }
std::optional<ExecutedBlock> Interpreter::next_block() { return machine_->next_block(); }
std::vector<Move> Interpreter::rest() { return machine_->rest(); }
MoveList Interpreter::rest_held() {
  MoveList out;
  while (const Move* move = machine_->next()) out.push_back(*move);
  return out;
}
const std::vector<Fault>& Interpreter::warnings() const { return machine_->warnings(); }

std::vector<Move> interpret(std::string text, std::string file, ProgramSetup setup) {
  return Interpreter(std::move(text), std::move(file), std::move(setup)).rest();
}

}  // namespace servomill::controllers

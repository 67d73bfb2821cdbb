#include "controllers/gcode/interpreter.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "controllers/gcode/interpreter_machine.h"
#include "controllers/gcode/macro/macro_program.h"
#include "controllers/gcode/message_text.h"
#include "controllers/gcode/other_language.h"
#include "controllers/translation/translated_program.h"
#include "plant/vocabulary/arc_sweep.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

}  // namespace

std::array<AxisWords, 9> ProgramSetup::zero_offsets() {
  std::array<AxisWords, 9> offsets;
  offsets.fill(AxisWords::Zero());
  return offsets;
}

const std::array<Interpreter::Machine::Step, 22> Interpreter::Machine::kSteps = {{
    {&Machine::message, kAlways},
    {&Machine::feed_mode, bit(Group::g_feed_mode)},
    {&Machine::feed, bit('F')},
    {&Machine::spindle_speed, bit('S')},
    {&Machine::select_tool, bit('T')},
    {&Machine::change_tool, bit(Group::m_tool)},
    {&Machine::spindle, bit(Group::m_spindle)},
    {&Machine::coolant, bit(Group::m_coolant)},
    {&Machine::override_switches, bit(Group::m_override)},
    {&Machine::output, bit(Group::m_input_output)},
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

ReadingOptions Interpreter::Machine::reading_options() {
  ReadingOptions out{setup_.reader, setup_.decimal_point, setup_.feed};
  out.accepts_unknown_dwells = setup_.accepts_unknown_dwells;
  out.accepts_unknown_positions = setup_.accepts_unknown_positions;
  out.accepts_unknown_feeds = setup_.accepts_unknown_feeds;
  out.ignored_codes = setup_.ignored_codes;
  out.refuses_code = setup_.refuses_code;
  out.is_trial = setup_.is_trial;
  out.radius_of = [this](int D) {
    const ToolEntry* tool = setup_.tools.find(D);
    return tool == nullptr ? 0.0 : 0.5 * tool->diameter;
  };
  if (setup_.reader != Reader::any) return out;
  setup_at_start_ = setup_;
  out.possible_readers = [this] { return possible_readers(); };
  return out;
}

const PossibleReaders* Interpreter::Machine::possible_readers() {
  if (setup_.trials && setup_.trials->found) possible_readers_ = setup_.trials->found;
  if (possible_readers_) return possible_readers_.get();
  const ProgramText& lines = texts_.front().lines;
  std::optional<ProgramText> written;  // a text that macros generate is judged by what was written
  if (lines.is_generated()) {
    written = lines.source()->written();
    if (!written) return nullptr;
  }
  possible_readers_ =
      std::make_shared<const PossibleReaders>(written ? *written : lines, *setup_at_start_);
  if (setup_.trials) setup_.trials->found = possible_readers_;
  return possible_readers_.get();
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
  if (F == 0.0) {
    noted_.insert("F0");
  } else {
    noted_.erase("F0");
  }
  set_feed(has_unknown_feed() ? kUnknownValue : F);
}

bool Interpreter::Machine::has_unknown_feed() const {
  return unknowns_.feed || (is_rewritten_ && reading_.has_unknown_feed());
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
                ? fmt::format("{}{} is not defined; pass a tool table with --tools", letter, number)
                : fmt::format("{}{} is not in the tool table", letter, number));
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

// M62 ... M65 switch an output, which moves nothing.
void Interpreter::Machine::output() {
  const auto& code = request().of(Group::m_input_output);
  if (request().has('P')) return;
  fail(code.column, fmt::format("{} requires a P word (output number)",
                                code_name('M', request().code(Group::m_input_output))));
}

// ------------------------------------------------------------------------------------- public API

Interpreter::Interpreter(ProgramText text, ProgramSetup setup) {
  translation::translate(text, setup);
  if (setup.reader != Reader::linuxcnc) {
    const std::string refusal = refused_program(text);
    if (!refusal.empty()) throw InputError({text.file(), 1, 1}, refusal);
  }
  if (!macro::is_macro_program(text, setup.reader)) {
    machine_ = std::make_unique<Machine>(std::move(text), std::move(setup));
    return;
  }
  const auto control = std::make_shared<macro::ControlState>();
  text = macro::as_gcode(std::move(text), setup, control);
  machine_ = std::make_unique<Machine>(std::move(text), std::move(setup));
  control->system_variable = [machine = machine_.get()](long number, std::string& why) {
    return machine->macro_variable(number, why);
  };
  control->is_inch = [machine = machine_.get()] { return machine->is_inch(); };
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
int Interpreter::unread_behind() const { return machine_->unread_behind(); }

std::vector<Move> interpret(std::string text, std::string file, ProgramSetup setup) {
  return Interpreter(std::move(text), std::move(file), std::move(setup)).rest();
}

}  // namespace servomill::controllers

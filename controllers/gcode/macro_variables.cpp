// System variables of Fanuc and Haas that a simulation knows.
// Source: Fanuc B-63944EN, custom macro, system variables; Haas Mill operator's manual, macro
// variables; both from memory. Where the two differ each reader has its own.
#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "controllers/gcode/interpreter_machine.h"

namespace servomill::controllers {
namespace {

constexpr long kEnd = 5001, kMachine = 5021, kCurrent = 5041, kExternalOffset = 5201,
               kLastOffset = 5326;

constexpr const char* kNoOffset =
    "the work offset is unknown; set it with --work-offset (other than 0) or --parameter-file";

// An offset that nobody has given is 0 here, and somewhere else on the machine.
bool is_offset_known(const Parameters& parameters, const std::map<int, double>& stored,
                     int system) {
  const int first = parameter::work_offset(system);
  if (stored.contains(first)) return true;
  for (int i = 0; i < kAxisWords; ++i) {
    if (parameters.get(first + i) != 0.0) return true;
  }
  return false;
}

constexpr std::string_view kOtherArithmetic =
    "FIX, FUP, ATAN and MOD follow LinuxCNC; Fanuc and Haas differ for negative numbers and in the "
    "range of angles; choose with --reader linuxcnc, fanuc or haas";

bool differs(OpCode code) {
  constexpr std::array kCodes = {OpCode::fix, OpCode::fup, OpCode::atan, OpCode::modulo};
  return std::find(kCodes.begin(), kCodes.end(), code) != kCodes.end();
}

}  // namespace

// A program that uses variables and says nowhere for which control: no O-words, no macro
// statements.
void Interpreter::Machine::note_other_arithmetic() {
  constexpr double kLastCommon = 999.0;
  const bool is_of_linuxcnc = block_.o_word.flow != Flow::none || !flow_.labels.empty() ||
                              !flow_.calls.empty() || text().is_generated();
  parameters_.leave_logic_open(!is_of_linuxcnc && block_.names.empty());
  if (is_of_linuxcnc) return;
  const auto note = [&](int column, const std::string& text) {
    if (noted_.insert(text).second) warn(column, text);
  };
  for (std::size_t i = 0; i < block_.code.size(); ++i) {
    const Op& op = block_.code[i];
    if (differs(op.code)) note(op.column, std::string(kOtherArithmetic));
    const bool has_number = op.code == OpCode::numbered && i > 0 &&
                            block_.code[i - 1].code == OpCode::push &&
                            block_.code[i - 1].value <= kLastCommon;
    if (!has_number) continue;
    const int number = static_cast<int>(block_.code[i - 1].value);
    const bool is_given = assigned_.contains(number) || setup_.stored.contains(number) ||
                          setup_.parameters.contains(fmt::format("#{}", number));
    if (is_given) continue;
    note(op.column,
         fmt::format("#{} is read before it is set: 0 (LinuxCNC), or vacant, so that its word is "
                     "ignored (Fanuc, Haas); choose with --reader linuxcnc, fanuc or haas",
                     number));
  }
}

// Lengths in the unit in force.
std::optional<double> Interpreter::Machine::macro_position(long number, std::string& why) const {
  const long first = number < kMachine ? kEnd : number < kCurrent ? kMachine : kCurrent;
  const long axis = number - first;
  if (axis >= kAxisWords) {
    why = "the axis does not exist";
    return std::nullopt;
  }
  const Axis one = axis_at(static_cast<int>(axis));
  const bool needs_length = one == Axis::Z || first == kMachine;
  if (needs_length && (state_.is_height_unknown || state_.is_length_unknown)) {
    why = "it depends on the unknown tool length; pass a tool table with --tools";
    return std::nullopt;
  }
  if (first != kEnd && state_.compensation.is_on) {
    why = "it is unknown with cutter compensation active; program G40 first";
    return std::nullopt;
  }
  if (first == kMachine && !is_offset_known(parameters_, setup_.stored, state_.work_system)) {
    why = kNoOffset;
    return std::nullopt;
  }
  if (first == kCurrent && state_.tool_offset != AxisWords::Zero()) {
    why = "controls differ in whether it includes the tool length; use #5001 and up";
    return std::nullopt;
  }
  const AxisWords at = first == kMachine ? machine_now(0) : state_.programmed();
  return at[axis] / unit_of(one);
}

// G code of a group that always has one: plane, distances, feed, units, compensations, cycle.
int Interpreter::Machine::setting_mode(long number) const {
  switch (number) {
    case 4002:
      return 19 - state_.normal_axis;
    case 4003:
      return state_.is_incremental ? 91 : 90;
    case 4005:
      if (state_.feed_mode == FeedMode::inverse_time) return 93;
      return state_.feed_mode == FeedMode::units_per_minute ? 94 : 95;
    case 4006:
      return is_inch() ? 20 : 21;
    case 4007:
      if (!state_.compensation.is_on) return 40;
      return state_.compensation.cutter.is_left ? 41 : 42;
    case 4008:
      return state_.tool_offset_number > 0 ? 43 : 49;
    default:
      return state_.motion > 30 ? state_.motion / 10 : 80;
  }
}

std::optional<double> Interpreter::Machine::macro_mode(long number, std::string& why) const {
  const auto code = [](double value) { return std::optional<double>(value); };
  const bool is_fanuc = setup_.reader == Reader::fanuc, is_haas = setup_.reader == Reader::haas;
  if (number == 4001 && state_.motion <= 30) return code(state_.motion / 10);
  if (number == 4001 && state_.motion == 800) {
    why =
        "no G0, G1, G2 or G3 precedes it: the active one depends on the control (Fanuc, parameter "
        "3402#0); program one";
  }
  if (number >= 4002 && number <= 4009 && number != 4004) return code(setting_mode(number));
  if (number == 4109 && state_.feed_linear > 0.0) return code(feed_in_force());
  if (number == 4119) return code(state_.spindle_speed / rpm);
  if (number == 4120 && state_.selected_tool >= 0) return code(state_.selected_tool);
  const bool is_work_system = (number == 4014 && is_fanuc) || (number == 4012 && is_haas);
  if (is_work_system && state_.work_system <= 6) return code(53 + state_.work_system);
  if (!is_work_system && (number == 4012 || number == 4014)) {
    why = "the work offset is #4014 (Fanuc) or #4012 (Haas); choose with --reader fanuc or haas";
  }
  if (why.empty()) why = "it is not simulated";
  return std::nullopt;
}

// Geometry of the length: Haas #2001 and up, Fanuc with tool memory C #11001 and up. What else
// there is (wear, radius or diameter, memories A and B) the tool table does not tell.
std::optional<double> Interpreter::Machine::macro_tool_length(long number, std::string& why) const {
  constexpr long kHaas = 2001, kFanuc = 11001;
  const bool is_haas = setup_.reader == Reader::haas && number >= kHaas && number < kHaas + 200;
  const bool is_fanuc = setup_.reader == Reader::fanuc && number >= kFanuc && number < kFanuc + 999;
  if (!is_haas && !is_fanuc) return std::nullopt;
  const int tool = static_cast<int>(number - (is_haas ? kHaas : kFanuc) + 1);
  const ToolEntry* entry = setup_.tools.entry_of(tool);
  if (entry == nullptr) {
    why = fmt::format("the length of tool {} is unknown; pass a tool table with --tools", tool);
    return std::nullopt;
  }
  return entry->offset[2] / state_.unit;
}

std::optional<double> Interpreter::Machine::macro_variable(long number, std::string& why) const {
  if ((number >= 2001 && number < 3000) || (number >= 10001 && number < 15000)) {
    return macro_tool_length(number, why);
  }
  if (number >= kEnd && number < kCurrent + 20) return macro_position(number, why);
  if (number >= 4001 && number < 4200) return macro_mode(number, why);
  const long axis = (number - kExternalOffset) % 20;
  const bool is_offset = number >= kExternalOffset + 20 && number <= kLastOffset;
  const int system = static_cast<int>((number - kExternalOffset) / 20);
  if (is_offset && !is_offset_known(parameters_, setup_.stored, system)) {
    why = kNoOffset;
    return std::nullopt;
  }
  if (is_offset && axis < kAxisWords) {
    const double value = parameters_.get(static_cast<int>(number));
    return axis < 3 ? value * mm / state_.unit : value;
  }
  return std::nullopt;
}

}  // namespace servomill::controllers

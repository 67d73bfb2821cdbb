#include "controllers/gcode/macro/variables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

namespace servomill::controllers::macro {
namespace {

struct Range {
  long first, last;
  std::string_view name;
};

// Fanuc B-63944EN and B-64304EN, custom macro, system variables; Haas Mill operator's manual,
// macro variables; both from memory
constexpr auto kSystem = std::to_array<Range>({
    {1000, 1035, "an input of the machine"},
    {1064, 1081, "an input of the machine"},
    {1100, 1139, "an output of the machine"},
    {2000, 2999, "a tool offset"},
    {3000, 3000, "the alarm"},
    {3001, 3002, "a timer"},
    {3003, 3004, "a switch for single block, feed hold and override"},
    {3005, 3005, "a setting"},
    {3006, 3006, "the stop with a message"},
    {3007, 3007, "the active mirror images"},
    {3008, 3010, "the state of a restart"},
    {3011, 3012, "date and time"},
    {3020, 3033, "a timer or an operator switch"},
    {3901, 3902, "the part count"},
    {4001, 4199, "an active mode"},
    {4201, 4499, "an active mode"},
    {5001, 5020, "the end position of the previous block"},
    {5021, 5040, "the machine position"},
    {5041, 5060, "the position in work coordinates"},
    {5061, 5080, "the position at the skip signal"},
    {5081, 5100, "the active tool offset"},
    {5101, 5120, "the following error"},
    {5201, 5220, "the external work offset"},
    {5221, 5400, "a work offset"},
    {5401, 5600, "tool data"},
    {6001, 7000, "a setting of the control"},
    {7001, 7960, "an additional work offset"},
    {8500, 8599, "tool data"},
    {10000, 14999, "a tool offset"},
    {100000, 100999, "a position"},
});

bool is_in(long number, long first, long last) { return first <= number && number <= last; }

}  // namespace

std::string_view system_variable_name(long number) {
  const auto* found = std::find_if(kSystem.begin(), kSystem.end(), [&](const Range& one) {
    return is_in(number, one.first, one.last);
  });
  return found == kSystem.end() ? std::string_view() : found->name;
}

Variables::Variables(MacroReading& reading, const std::map<std::string, double>& given,
                     std::shared_ptr<const ControlState> control)
    : reading_(reading), control_(std::move(control)) {
  for (const auto& [name, value] : given) {
    if (name.size() < 2 || name[0] != '#' || name[1] == '<') continue;
    const long number = std::atol(name.c_str() + 1);
    if (is_in(number, 1, kLocals)) {
      levels_.back()[static_cast<std::size_t>(number)] = value;
    } else {
      common_[number] = value;
    }
  }
}

// Haas has its common variables once more from #10000 on, where Fanuc has tool offsets.
Variables::Kind Variables::kind_of(long number) const {
  if (number == 0) return Kind::vacant;
  if (is_in(number, 1, kLocals)) return Kind::local;
  if (is_in(number, 100, 499)) return Kind::volatile_common;
  if (is_in(number, 500, 999)) return Kind::kept_common;
  if (reading_.reader() == Reader::haas && is_in(number, 10000, 10999)) return Kind::kept_common;
  if (is_in(number, 98000, 98499)) return Kind::volatile_common;
  if (is_in(number, 900000, 907399)) return Kind::kept_common;
  return number >= 1000 ? Kind::system : Kind::none;
}

bool Variables::is_of_system(long number) const { return kind_of(number) == Kind::system; }

MacroValue Variables::unset(long number, Kind kind, const Place& place) const {
  if (kind == Kind::kept_common) {
    reading_.fail(place, fmt::format("#{0} keeps its value from earlier programs and is not set in "
                                     "this program; set it with --parameter '#{0}=...'",
                                     number));
  }
  reading_.choose(WordDifference::common_variable, place);
  reading_.warn(
      place,
      fmt::format("#{} is read before it is set: treated as vacant, as after power-on", number));
  return std::nullopt;
}

MacroValue Variables::read(long number, const Place& place) const {
  const Kind kind = kind_of(number);
  if (kind == Kind::vacant) return std::nullopt;
  if (kind == Kind::local) return levels_.back()[static_cast<std::size_t>(number)];
  if (kind == Kind::none)
    reading_.refuse(place, fmt::format("variable #{} does not exist", number));
  if (const auto found = common_.find(number); found != common_.end()) return found->second;
  if (kind != Kind::system) {
    return unset(number, kind, place);
  }
  std::string why;
  const std::optional<double> value =
      control_->system_variable ? control_->system_variable(number, why) : std::nullopt;
  if (value) return value;
  if (why.empty()) why = "it is unknown in a simulation";
  why += fmt::format("; or set it with --parameter '#{}=...'", number);
  const std::string_view name = system_variable_name(number);
  reading_.fail(
      place, fmt::format("#{} is {}: {}", number, name.empty() ? "a control variable" : name, why));
}

void Variables::write(long number, MacroValue value, const Place& place) {
  const Kind kind = kind_of(number);
  if (kind == Kind::vacant) reading_.refuse(place, "#0 is always vacant and cannot be set");
  if (kind == Kind::none)
    reading_.refuse(place, fmt::format("variable #{} does not exist", number));
  if (kind == Kind::local) {
    levels_.back()[static_cast<std::size_t>(number)] = value;
  } else {
    common_[number] = value;
  }
}

Locals Variables::leave() {
  Locals out = levels_.back();
  levels_.pop_back();
  return out;
}

}  // namespace servomill::controllers::macro

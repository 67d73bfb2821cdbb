/// Variables of custom macro B: local, common and those of the system.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "controllers/gcode/macro/control_state.h"
#include "controllers/gcode/macro/reading.h"

namespace servomill::controllers::macro {

/// nullopt: vacant, which is not 0.
using MacroValue = std::optional<double>;

inline constexpr int kLocals = 33;
using Locals = std::array<MacroValue, kLocals + 1>;  // [0] is #0, vacant

/// "a timer": meaning of a system variable; empty: not known.
std::string_view system_variable_name(long number);

class Variables {
 public:
  /// @param given  "#500" and its value, from the user
  Variables(MacroReading& reading, const std::map<std::string, double>& given,
            std::shared_ptr<const ControlState> control);

  /// @throws InputError for a variable whose value is not known
  MacroValue read(long number, const Place& place) const;
  /// Writes a local or common variable.
  /// @pre !is_of_system(number)
  /// @throws InputError for a variable that does not exist or that a program cannot set
  void write(long number, MacroValue value, const Place& place);
  bool is_of_system(long number) const;

  /// A new level of local variables, and back to the one before.
  void enter(const Locals& locals) { levels_.push_back(locals); }
  Locals leave();
  const Locals& locals() const { return levels_.back(); }

 private:
  enum class Kind { none, vacant, local, volatile_common, kept_common, system };
  Kind kind_of(long number) const;
  MacroValue unset(long number, Kind kind, const Place& place) const;

  MacroReading& reading_;
  std::shared_ptr<const ControlState> control_;
  std::vector<Locals> levels_{Locals()};
  std::map<long, MacroValue> common_;
};

}  // namespace servomill::controllers::macro

/// Answers of the control that runs a macro.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace servomill::controllers::macro {

/// Behind the block that ran last.
struct ControlState {
  /// A system variable, #1000 and up. nullopt where a simulation cannot know it.
  /// @param why  set to the reason then
  std::function<std::optional<double>(long number, std::string& why)> system_variable = {};
  std::function<bool()> is_inch = {};
};

}  // namespace servomill::controllers::macro

/// Every key of scenarios and machines, as the readers ask for them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/config/key_log.h"

namespace servomill::sim::input {

/// The name by which the keys without a section are asked for.
inline constexpr std::string_view kTopSection = "top";

/// One key of a section, all requests for it taken together.
struct KeyEntry {
  std::string section;  // "machine.nc"; empty: the root. NAME, EXX, EC0Y, X stand for any such name
  std::string key;
  std::string type;       // "number in mm", "\"a\" | \"b\"", "list of tables"
  std::string range;      // "> 0"; empty: none
  std::string presence;   // "required", "default 1", "optional", "default follows from other keys"
  std::string_view help;  // empty: missing
  // unit of a bare number, "kg | kg m^2" of linear and rotary axes; empty: none
  std::string unit = {};
};

/// All keys, sections in the order in which they are read.
std::vector<KeyEntry> list_keys();

/// Keys of a section and those below it; empty: of all; "top": of those without a section.
/// @throws InputError if there are none, with the nearest name
std::vector<KeyEntry> keys_of(std::string_view section);

}  // namespace servomill::sim::input

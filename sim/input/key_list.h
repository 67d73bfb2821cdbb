/// Every key of scenarios and machines, as the readers ask for them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/config/key_log.h"

namespace servomill::sim {

/// One key of a section, all requests for it taken together.
struct KeyEntry {
  std::string section;  // "machine.nc"; empty: the root. NAME, EXX, EC0Y, X stand for any such name
  std::string key;
  std::string type;       // "number in mm", "\"a\" | \"b\"", "list of tables"
  std::string range;      // "> 0"; empty: none
  std::string presence;   // "required", "default 1", "optional", "default follows from other keys"
  std::string_view help;  // empty: missing
};

/// All keys, sections in the order in which they are read.
std::vector<KeyEntry> list_keys();

/// The list as text, of all sections or of those whose name begins with `section`.
/// @throws InputError if there is none, with the nearest name
std::string describe_keys(std::string_view section);

/// Sentence about a key; empty if there is none.
std::string_view help_of_key(std::string_view section, std::string_view key);
/// Sections and keys of all sentences, for the law that none is left over.
std::vector<std::pair<std::string_view, std::string_view>> keys_with_help();

}  // namespace servomill::sim

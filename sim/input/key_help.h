/// Sentences about the keys of scenario and machine files: what a key describes, and a default that
/// follows from other keys. The lists of keys and the error messages are made from the readers;
/// only these sentences are written by hand.
#pragma once

#include <span>
#include <string_view>

namespace servomill::sim::input {

struct KeyHelp {
  std::string_view section, key, sentence;
};

/// Keys of a scenario, except for those of its machine.
std::span<const KeyHelp> scenario_key_help();

/// Keys of a machine: the section of a scenario, or a file of its own.
std::span<const KeyHelp> machine_key_help();

/// The sentence of a key as list_keys() names it; empty: it has none.
std::string_view help_of_key(std::string_view section, std::string_view key);

}  // namespace servomill::sim::input

/// Lists of all that can be chosen, as text for people: derived from the tables that the program
/// itself uses.
#pragma once

#include <string>

namespace servomill::sim::input {

/// Every strategy with its keys, units, defaults and words.
std::string describe_strategies();

/// Every quantity that a comparison can hold.
std::string describe_quantities();

/// Every rule by which programs are read beyond LinuxCNC's, with readers and source.
std::string describe_reader_rules();

/// `title` of a scenario or `name` of a machine; the fault if it cannot be read.
std::string title_of(const std::string& path);

}  // namespace servomill::sim::input

/// Lists of all that can be chosen, as text for people and as JSON objects: derived from the tables
/// that the program itself uses.
#pragma once

#include <string>
#include <vector>

namespace servomill::sim::input {

/// Every strategy with its keys, units, defaults and words.
std::string describe_strategies();

/// Every quantity that a comparison can hold.
std::string describe_quantities();

/// Every rule by which programs are read beyond LinuxCNC's, with readers and source.
std::string describe_reader_rules();

/// The same, one object each; of what controls read differently one for each reading.
std::vector<std::string> strategies_json();
std::vector<std::string> quantities_json();
std::vector<std::string> reader_rules_json();

/// `title` of a scenario or `name` of a machine; the fault if it cannot be read.
std::string title_of(const std::string& path);

}  // namespace servomill::sim::input

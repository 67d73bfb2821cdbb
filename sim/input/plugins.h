/// Plug-ins that the user names: on the command line, and in scenarios.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "plant/vocabulary/parameters.h"

namespace servomill::sim::config {
class Reader;
}  // namespace servomill::sim::config

namespace servomill::sim::input {

/// Loads a shared library with strategies; scenarios that are read from now on find them.
/// @throws InputError as strategies::load_plugin does
void load_plugin(const std::string& file);

/// From now on plug-ins compute in processes of their own, where a run can do so.
void isolate_plugins();

/// Sets the function that receives, on a thread of its own, a sentence about a plug-in that did not
/// return or crashed, before the process ends with status 3.
void on_plugin_failure(std::function<void(const std::string& why)> then);

/// A number without a unit that is known would be taken as one in SI.
/// @param from  of messages: who declares the parameters of the strategy
/// @throws InputError for a parameter of a strategy that has an unknown unit
void refuse_unknown_units(std::span<const ParameterSpec> parameters, std::string_view strategy,
                          const std::string& from);

/// Loads those of the key `plugins` of a scenario. A resolved document has the names of the files
/// alone, and those must have been loaded: reading a result runs no code that it names.
/// @return what the resolved document has of all that are loaded: "plugins=[...]"; or empty
/// @throws InputError
std::string read_plugins(config::Reader& root);

}  // namespace servomill::sim::input

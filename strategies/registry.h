/// The list of strategies. Allowed names, keys, help texts and error messages all follow from it.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "strategies/entry.h"

namespace servomill::strategies {

/// All strategies of the tree, sorted by name.
std::span<const Entry> entries();

/// The entry of that name, of the tree or of a plug-in (strategies/plugin_file.h); or nullptr.
const Entry* find(std::string_view name);

/// Entries of the tree and of plug-ins.
std::vector<std::string_view> names();

}  // namespace servomill::strategies

/// Strategies in C (strategies/plugin_c.h) as entries like those of the tree.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "strategies/entry.h"
#include "strategies/plugin_c.h"

namespace servomill::strategies {

/// An entry with the texts and keys that it refers to.
struct OwnedEntry {
  std::string label;  // "strategy ramp (libramp.so)"
  std::vector<ParameterSpec> parameters;
  servomill_strategy declared;  // with what an older library does not know as NULL
  Entry entry;
};

/// @param file  of the plug-in
/// @pre wrong_with(declared) is empty (strategies/c_declaration.h); what it points to outlives the
/// entry, as does the entry all runs
std::unique_ptr<OwnedEntry> entry_of(const servomill_strategy& declared, const std::string& file);

}  // namespace servomill::strategies

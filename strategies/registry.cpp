#include "strategies/registry.h"

#include <array>

#include "strategies/cross_coupling.h"
#include "strategies/exact.h"
#include "strategies/feedback.h"
#include "strategies/gcode.h"
#include "strategies/harmonic.h"
#include "strategies/inertia.h"
#include "strategies/learning.h"
#include "strategies/none.h"
#include "strategies/parabolic.h"
#include "strategies/plugin_file.h"
#include "strategies/precompensation.h"
#include "strategies/table.h"
#include "strategies/thermal.h"

namespace servomill::strategies {

std::span<const Entry> entries() {
  static const std::array kEntries = {contour_entry(),         exact_entry(),    feedback_entry(),
                                      gcode_entry(),           harmonic_entry(), inertia_entry(),
                                      learning_entry(),        none_entry(),     parabolic_entry(),
                                      precompensation_entry(), table_entry(),    thermal_entry()};
  return kEntries;
}

const Entry* find(std::string_view name) {
  for (const Entry& entry : entries()) {
    if (entry.name == name) return &entry;
  }
  return find_in_plugins(name);
}

std::vector<std::string_view> names() {
  std::vector<std::string_view> out;
  for (const Entry& entry : entries()) out.push_back(entry.name);
  for (const LoadedPlugin& plugin : loaded_plugins()) {
    for (const Entry* entry : plugin.entries) out.push_back(entry->name);
  }
  return out;
}

}  // namespace servomill::strategies

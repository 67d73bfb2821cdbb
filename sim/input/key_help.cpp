#include "sim/input/key_help.h"

#include <algorithm>

namespace servomill::sim::input {

std::string_view help_of_key(std::string_view section, std::string_view key) {
  if (section == "machine.axis.X.motor") section = "machine.axis.X.scale";
  if (section == "case.work_offset") section = "program.work_offset";
  for (const auto& rows : {scenario_key_help(), machine_key_help()}) {
    const auto at = std::find_if(rows.begin(), rows.end(), [&](const KeyHelp& one) {
      return one.section == section && one.key == key;
    });
    if (at != rows.end()) return at->sentence;
  }
  return {};
}

}  // namespace servomill::sim::input

#include "sim/input/known_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "plant/vocabulary/input_error.h"

namespace servomill::sim::input {

bool must_be_known(config::Reader& table, std::string_view key, const std::string& name,
                   std::string_view what, std::span<const std::string> names) {
  if (std::find(names.begin(), names.end(), name) != names.end()) return true;
  const std::string all = names.empty() ? std::string("; none is defined")
                                        : fmt::format("; known are: {}", fmt::join(names, ", "));
  const std::vector<std::string_view> views(names.begin(), names.end());
  const std::string near = did_you_mean(name, views);
  table.fault(key, fmt::format("no such {}{}", what, near.empty() ? all : near));
  return false;
}

}  // namespace servomill::sim::input

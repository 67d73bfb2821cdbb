#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "sim/run/build_identity.h"
#include "strategies/plugin_file.h"

namespace servomill::sim::run {

std::string result_identity() {
  std::vector<std::string> plugins;
  for (const strategies::LoadedPlugin& one : strategies::loaded_plugins()) {
    plugins.push_back(one.identity());
  }
  if (plugins.empty()) return std::string(build_identity());
  std::sort(plugins.begin(), plugins.end());
  return fmt::format("{} with {}", build_identity(), fmt::join(plugins, ", "));
}

}  // namespace servomill::sim::run

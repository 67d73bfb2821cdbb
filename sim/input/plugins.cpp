#include "sim/input/plugins.h"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include "sim/config/quantity.h"
#include "sim/config/reader.h"
#include "sim/input/scenario_document.h"
#include "strategies/plugin_child.h"
#include "strategies/plugin_file.h"
#include "strategies/plugin_watch.h"

namespace servomill::sim::input {
namespace {

// In resolved documents: a result is data, and must not have code run that it names.
constexpr std::string_view kLoaded = "loaded:";

void load(const std::string& file, const Place& at) {
  strategies::load_plugin(file, at);
  for (const strategies::LoadedPlugin& plugin : strategies::loaded_plugins()) {
    for (const strategies::Entry* entry : plugin.entries) {
      refuse_unknown_units(entry->parameters, entry->name, plugin.file);
    }
  }
}

}  // namespace

void refuse_unknown_units(std::span<const ParameterSpec> parameters, std::string_view strategy,
                          const std::string& from) {
  for (const ParameterSpec& one : parameters) {
    if (one.unit.empty() || config::parse_unit(one.unit).unit) continue;
    throw InputError({from}, fmt::format("strategy {}: parameter {} has the unknown unit '{}'",
                                         strategy, one.name, one.unit));
  }
}

void load_plugin(const std::string& file) { load(file, {}); }

void isolate_plugins() { strategies::isolate_plugins(); }

void on_plugin_failure(std::function<void(const std::string& why)> then) {
  strategies::on_plugin_failure(std::move(then));
}

std::string read_plugins(config::Reader& root) {
  const Place at = root.place("plugins");
  for (const std::string& name : root.texts_or("plugins", {})) {
    if (!name.starts_with(kLoaded)) {
      load(beside(at, name), at);
    } else if (const std::string file = name.substr(kLoaded.size());
               !strategies::is_loaded_by_name(file)) {
      throw InputError(
          at, fmt::format("was computed with the plug-in {}: pass it with --plugin", file));
    }
  }
  std::vector<std::string> files;
  for (const strategies::LoadedPlugin& one : strategies::loaded_plugins()) {
    const std::filesystem::path file = one.file;
    files.push_back(config::quoted_text(std::string(kLoaded) + file.filename().string()));
  }
  return files.empty() ? "" : fmt::format("plugins=[{}]", fmt::join(files, ", "));
}

}  // namespace servomill::sim::input

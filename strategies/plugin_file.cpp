#include "strategies/plugin_file.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <filesystem>
#include <memory>
#include <mutex>

#include "plant/vocabulary/checksum.h"
#include "plant/vocabulary/user_file.h"
#include "strategies/c_declaration.h"
#include "strategies/c_strategy.h"
#include "strategies/plugin_watch.h"
#include "strategies/registry.h"

namespace servomill::strategies {
namespace {

// Libraries stay until the process ends: entries refer to their code.
struct Plugins {
  std::mutex loading;
  std::vector<LoadedPlugin> all;
  std::deque<std::unique_ptr<OwnedEntry>> entries;
};

Plugins& plugins() {
  static Plugins all;
  return all;
}

// One file that is being loaded, and how its faults are reported.
class Loading {
 public:
  Loading(std::string path, const Place& at) : path_(std::move(path)), at_(at) {}

  [[noreturn]] void refuse(const std::string& why) const {
    if (at_.file.empty()) throw InputError({path_}, why);
    throw InputError(at_, fmt::format("{}: {}", path_, why));
  }

  LoadedPlugin load() const {
    std::string why;
    const std::string bytes = read_input(path_, kMaxBytesOfFile, why);
    if (!why.empty()) refuse(why);
    const servomill_plugin_c& plugin = open();
    check(plugin);
    LoadedPlugin out{.file = path_,
                     .name = plugin.name,
                     .version = plugin.version,
                     .checksum = crc64(bytes),
                     .entries = {}};
    std::vector<std::unique_ptr<OwnedEntry>> entries;
    for (std::size_t n = 0; n < plugin.strategy_count; ++n) {
      const servomill_strategy& declared = *plugin.strategies[n];
      if (const std::string wrong = wrong_with(declared); !wrong.empty()) {
        refuse(fmt::format("strategy {}: {}", n + 1, wrong));
      }
      const std::string_view name = declared.name;
      const bool twice = std::any_of(entries.begin(), entries.end(),
                                     [&](const auto& other) { return other->entry.name == name; });
      if (twice || find(name) != nullptr) {
        refuse(fmt::format("its strategy '{}' has the name of another one", name));
      }
      entries.push_back(entry_of(declared, path_));
    }
    for (auto& entry : entries) {
      out.entries.push_back(&entry->entry);
      plugins().entries.push_back(std::move(entry));
    }
    return out;
  }

 private:
  const servomill_plugin_c& open() const {
    // a name without '/' would be looked for in the folders of the system
    const std::string path = std::filesystem::absolute(path_).string();
    watch_plugins();
    const PluginCall call(path_.c_str());  // constructors of the library, too
    void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) {
      std::string why = dlerror();
      if (why.starts_with(path + ": ")) why.erase(0, path.size() + 2);
      refuse("cannot be loaded: " + why);
    }
    const auto entry =
        reinterpret_cast<servomill_plugin_c_function>(dlsym(library, SERVOMILL_PLUGIN_C_ENTRY));
    if (entry == nullptr) {
      refuse("is not a plug-in: it does not export the function " SERVOMILL_PLUGIN_C_ENTRY);
    }
    const servomill_plugin_c* plugin = entry();
    if (plugin == nullptr) refuse(SERVOMILL_PLUGIN_C_ENTRY " returned NULL");
    return *plugin;
  }

  void check(const servomill_plugin_c& plugin) const {
    if (plugin.abi != SERVOMILL_PLUGIN_ABI) {
      refuse(
          fmt::format("was built for version {} of the plug-in interface, this program has {}; "
                      "rebuild it with the headers of this program",
                      plugin.abi, SERVOMILL_PLUGIN_ABI));
    }
    if (plugin.size < sizeof plugin) {
      refuse(fmt::format("its struct servomill_plugin_c has {} bytes, expected at least {}",
                         plugin.size, sizeof plugin));
    }
    if (plugin.name == nullptr || plugin.version == nullptr) refuse("lacks a name or a version");
    if (plugin.strategy_count == 0) refuse("has no strategy");
  }

  std::string path_;
  Place at_;
};

}  // namespace

std::string LoadedPlugin::identity() const {
  return fmt::format("{} {} ({:016x})", name, version, checksum);
}

void load_plugin(const std::string& path, const Place& at) {
  Plugins& known = plugins();
  const std::scoped_lock lock(known.loading);
  const bool is_loaded =
      std::any_of(known.all.begin(), known.all.end(), [&](const LoadedPlugin& one) {
        std::error_code error;
        return one.file == path || std::filesystem::equivalent(one.file, path, error);
      });
  if (!is_loaded) known.all.push_back(Loading(path, at).load());
}

void add_plugin(LoadedPlugin plugin) {
  Plugins& known = plugins();
  const std::scoped_lock lock(known.loading);
  const auto same = std::find_if(known.all.begin(), known.all.end(),
                                 [&](const LoadedPlugin& one) { return one.file == plugin.file; });
  const auto is_replaced = [&](const Entry* entry) {
    return same != known.all.end() && std::count(same->entries.begin(), same->entries.end(), entry);
  };
  for (const Entry* entry : plugin.entries) {
    const Entry* const other = find(entry->name);
    if (other == nullptr || is_replaced(other)) continue;
    throw InputError({plugin.file},
                     fmt::format("the name '{}' belongs to another strategy", entry->name));
  }
  if (same != known.all.end()) {
    *same = std::move(plugin);
  } else {
    known.all.push_back(std::move(plugin));
  }
}

bool is_loaded_by_name(const std::string& path) {
  const std::filesystem::path name = std::filesystem::path(path).filename();
  return std::any_of(plugins().all.begin(), plugins().all.end(), [&](const LoadedPlugin& one) {
    return std::filesystem::path(one.file).filename() == name;
  });
}

std::span<const LoadedPlugin> loaded_plugins() { return plugins().all; }

const Entry* find_in_plugins(std::string_view name) {
  for (const LoadedPlugin& plugin : plugins().all) {
    for (const Entry* entry : plugin.entries) {
      if (entry->name == name) return entry;
    }
  }
  return nullptr;
}

}  // namespace servomill::strategies

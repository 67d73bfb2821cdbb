/// Strategies out of the tree: shared libraries that are loaded at run time.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "plant/vocabulary/input_error.h"
#include "strategies/entry.h"

namespace servomill::strategies {

/// A library that has been loaded.
struct LoadedPlugin {
  std::string file;            // as it was named first
  std::string name, version;   // as it says
  std::uint64_t checksum = 0;  // of the file: CRC-64 of ECMA-182, as xz takes it
  std::vector<const Entry*> entries;

  /// "springback 1.2 (9c3e...)", by which results say what computed them.
  std::string identity() const;
};

/// Loads a library; once, however often it is asked for. Its strategies are then found like those
/// of the tree (strategies/registry.h) until the program ends.
/// @param at  where the file was named; without a file: the complaint stands in `path`
/// @throws InputError if it cannot be read, is no plug-in, has another ABI version, or declares a
///         strategy that is faulty or whose name is taken
void load_plugin(const std::string& path, const Place& at = {});

/// Makes strategies known that this process itself holds; they are found like those of a library.
/// They replace those of an earlier plug-in with the same `file`, whose entries must stay for the
/// scenarios that have been read with them. Not while a scenario is read or runs.
/// @param plugin  its entries must stay until the process ends
/// @throws InputError if another plug-in or the tree has a strategy of that name
void add_plugin(LoadedPlugin plugin);

/// Tells if a library with the file name of this path has been loaded.
bool is_loaded_by_name(const std::string& path);

/// All that have been loaded, in that order. Not while one is being loaded.
std::span<const LoadedPlugin> loaded_plugins();

/// The strategy of a plug-in with that name, or nullptr.
const Entry* find_in_plugins(std::string_view name);

}  // namespace servomill::strategies

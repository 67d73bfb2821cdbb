/// A scenario from which others are made that differ in some keys: the points of a sweep.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/input/read_scenario.h"
#include "sim/model/forward.h"

namespace servomill::sim::input {

/// A scenario and the files that it names, each read once. For any number of threads.
///
///     ScenarioSource(path, a).at(b) = read_scenario(path, a and then b)                        (1)
class ScenarioSource {
 public:
  /// @param path     of the scenario; other paths are relative to it
  /// @param changes  what --set says, in order
  /// @param text     of the scenario, which then need not be on a disk; none: that of the file
  /// @throws InputError if a file cannot be read or is not TOML, or a change makes no sense
  explicit ScenarioSource(const std::string& path, std::vector<std::string> changes = {},
                          std::optional<std::string> text = {});
  ~ScenarioSource();
  ScenarioSource(ScenarioSource&&) noexcept;

  /// @param more  changes that come after the others
  /// @throws InputError with all faults of a file at once
  model::Scenario at(const std::vector<std::string>& more = {}) const;

  /// A number that other contents of a file do not have (sim/input/input_files.h); none, if it
  /// cannot be read. The scenario and its changes see the file as it is now, whatever becomes of
  /// it.
  std::optional<std::uint64_t> checksum(const std::string& path) const;

  /// Machine files that one is based on, also those in between; none, if it cannot be read.
  std::vector<std::string> bases_of_machine(const std::string& path) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace servomill::sim::input

/// A scenario from which others are made that differ in some keys: the points of a sweep.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "sim/config/document.h"
#include "sim/scenario.h"

namespace servomill::sim {

class InputFiles;

/// A scenario and the files that it names, read once.
/// `ScenarioSource(path, a).at(b)` is `read_scenario(path, a and then b)`, for any number of
/// threads.
class ScenarioSource {
 public:
  /// @param path     of the scenario; other paths are relative to it
  /// @param changes  what --set says, in order
  /// @throws InputError if a file cannot be read or is not TOML, or a change makes no sense
  explicit ScenarioSource(std::string path, std::vector<std::string> changes = {});
  ~ScenarioSource();

  /// @param more  changes that come after the others
  /// @throws InputError with all faults of a file at once
  Scenario at(const std::vector<std::string>& more = {}) const;

 private:
  std::string path_;
  std::vector<std::string> changes_;
  std::unique_ptr<InputFiles> files_;
  Document document_;     // as the files say
  LoadedScenario base_;   // with the machine and all changes in it
};

}  // namespace servomill::sim

/// Scenarios as Python holds them: read and checked, with what they were read from.
#pragma once

#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <vector>

#include "sim/model/scenario.h"

namespace servomill::python {

struct LoadedScenario {
  std::string path;                  // of the file, or the name of the text
  std::vector<std::string> changes;  // KEY=VALUE
  std::optional<std::string> text;   // in place of the file
  sim::model::Scenario scenario;
};

/// @throws InputError with all faults
LoadedScenario load_scenario(const std::string& path, const pybind11::object& set,
                             std::optional<std::string> text);

void bind_scenario(pybind11::module_& module);

}  // namespace servomill::python

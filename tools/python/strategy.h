/// Strategies that are classes of Python, for prototypes: each call takes some microseconds and the
/// GIL, so that runs on several threads wait for each other where they call.
#pragma once

#include <pybind11/pybind11.h>

#include <deque>
#include <memory>
#include <string>
#include <vector>

#include "strategies/entry.h"

namespace servomill::python {

/// A key of the strategy, as strategies/plugin_c.h has it.
struct DeclaredKey {
  std::string name, help, unit, default_text;
  double min = 0.0, max = 0.0;
};

/// A class as it is registered. Stays until the process ends: scenarios refer to it.
struct DeclaredStrategy {
  std::string name, summary, label;  // label: "strategy NAME (Python)"
  std::string source;                // text of the class, by which results know it
  pybind11::object make;             // make(setup): an object of the class
  bool has_offset = false, has_step = false, has_rewrite = false;
  bool keeps_no_state = false;  // one object for all runs, whose calls have rows of several
  bool knows_errors = false, displaces_rotary = false;
  std::vector<DeclaredKey> keys;
  std::vector<ParameterSpec> specs;  // of the keys
  strategies::Entry entry;
};

/// The strategy that a class is.
std::unique_ptr<strategies::Strategy> make_strategy(
    const DeclaredStrategy& declared, const Parameters& parameters, strategies::Action action,
    const strategies::IdentifiedMachine& identified);

void bind_strategies(pybind11::module_& module);

}  // namespace servomill::python

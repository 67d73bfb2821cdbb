/// Status of the functions of FMI 3.0.
#pragma once

#include <string>

#include "sim/fmu/library/component.h"
#include "sim/fmu/library/fmi3_functions.h"

namespace servomill::sim::fmu {

inline Component& component_of(fmi3Instance instance) { return *static_cast<Component*>(instance); }

/// Status of `run`, which is bool(Component&).
template <class Run>
fmi3Status status_of(fmi3Instance instance, Run run) {
  if (instance == nullptr) return fmi3Error;
  Component& component = component_of(instance);
  return component.does([&] { return run(component); }) ? fmi3OK : fmi3Error;
}

inline fmi3Status unsupported(fmi3Instance instance, const char* what) {
  return status_of(
      instance, [&](Component& it) { return it.refuse(std::string(what) + " is not supported"); });
}

}  // namespace servomill::sim::fmu

/// Sweeps for Python.
#pragma once

#include <pybind11/pybind11.h>

namespace servomill::python {

void bind_sweep(pybind11::module_& module);

}  // namespace servomill::python

/// G-code programs for Python: canonical moves, correction, post-processing.
#pragma once

#include <pybind11/pybind11.h>

namespace servomill::python {

void bind_programs(pybind11::module_& module);

}  // namespace servomill::python

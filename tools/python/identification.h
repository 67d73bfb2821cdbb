/// Machines from measurements, for Python: drives from recordings, errors from readings.
#pragma once

#include <pybind11/pybind11.h>

namespace servomill::python {

void bind_identification(pybind11::module_& module);
void bind_calibration(pybind11::module_& module);

}  // namespace servomill::python

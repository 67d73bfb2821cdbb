/// Lines of a comparison for Python.
#pragma once

#include <pybind11/pybind11.h>

#include <span>

#include "sim/evaluation/comparison.h"

namespace servomill::python {

/// The lines as tuples in the order of the fields of servomill.Row.
pybind11::list rows_of(std::span<const sim::evaluation::ComparisonRow> rows);

void bind_comparison(pybind11::module_& module);

}  // namespace servomill::python

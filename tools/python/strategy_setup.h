/// Knowledge of a strategy that is a class of Python, and calls of its objects.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <map>
#include <memory>
#include <span>
#include <string>

#include "plant/vocabulary/axes.h"
#include "strategies/strategy.h"
#include "tools/python/strategy.h"

namespace servomill::python {

/// Declaration and parameters of a strategy, shared by its runs.
struct MadeStrategy {
  const DeclaredStrategy* declared;
  std::map<std::string, double> parameters;  // SI
  strategies::Action action;
  strategies::IdentifiedMachine identified;
};
using Made = std::shared_ptr<const MadeStrategy>;

/// Argument of the class: servomill.Setup.
struct Setup {
  Made made;
  double period;  // s, between two calls; NaN: not known (offset, rewrite)

  /// Displacement of the tool centre point along X, Y and Z (..., 3; m) that the identified errors
  /// cause at Q (..., 5; m, rad). @throws ValueError for a strategy that knows none
  pybind11::array error(const pybind11::array& Q) const;
};

void bind_setup(pybind11::module_& module);

/// An object of Python that any thread may hold and let go.
using Held = std::shared_ptr<pybind11::object>;
/// @pre this thread has the GIL
Held held(pybind11::object object);

/// An object of the class for one run. @pre this thread has the GIL
Held instance_of(const Made& made, double period);

/// "ValueError: too far (mine.py:12)". @pre this thread has the GIL
std::string in_one_line(const pybind11::error_already_set& error);

/// Calls a function of a strategy with rows of joints and takes as many back.
/// @param function  "step", "offset"
/// @param Q         rows of 5 (m, rad)
/// @param is_single  the function takes and returns one row alone
/// @throws std::runtime_error where the result has another shape or is not finite; what it throws
/// @pre this thread has the GIL
void call_with_rows(const pybind11::object& object, const char* function, bool is_single,
                    std::span<const double> Q, std::span<double> out);

}  // namespace servomill::python

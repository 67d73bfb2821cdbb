#include "tools/python/strategy_setup.h"

#include <pybind11/eigen.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "strategies/axis_displacement.h"
#include "tools/python/computing.h"

namespace servomill::python {
namespace {

namespace py = pybind11;

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

std::vector<std::string> axes_of(const Setup& setup) {
  const JointLayout& layout = setup.made->identified.layout;
  std::vector<std::string> out;
  for (int j = 0; j < kJoints; ++j) {
    out.push_back(layout.has(j) ? std::string(1, layout.letter_of(j)) : "");
  }
  return out;
}

std::string shape_text(const py::array& array) {
  return std::string(py::str(py::object(array.attr("shape"))));
}

// Last line of the traceback that lies in a file: " (mine.py:12)".
std::string place_of(const py::error_already_set& error) {
  if (!error.trace()) return {};
  const py::object frames = py::module_::import("traceback").attr("extract_tb")(error.trace());
  if (py::len(frames) == 0) return {};
  const py::object last = frames[py::int_(-1)];
  const py::object name = py::module_::import("os.path").attr("basename")(last.attr("filename"));
  return " (" + std::string(py::str(name)) + ":" + std::string(py::str(last.attr("lineno"))) + ")";
}

}  // namespace

Held held(py::object object) {
  return {new py::object(std::move(object)), [](py::object* one) {
            const py::gil_scoped_acquire acquired;
            delete one;
          }};
}

Held instance_of(const Made& made, double period) {
  const InsideComputation mark;
  return held(made->declared->make(Setup{made, period}));
}

std::string in_one_line(const py::error_already_set& error) {
  std::string text = std::string(py::str(error.type().attr("__name__")));
  const std::string value = py::str(error.value());
  if (!value.empty()) text += ": " + value;
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text + place_of(error);
}

py::array Setup::error(const py::array& Q) const {
  if (!made->declared->knows_errors) {
    throw py::value_error("the strategy is not declared with knows_errors=True");
  }
  const Doubles given = Doubles::ensure(Q);
  if (!given || given.ndim() < 1 || given.shape(given.ndim() - 1) != kJoints) {
    throw py::value_error("Q has the shape " + shape_text(Q) + ", expected (..., 5)");
  }
  std::vector<py::ssize_t> shape(given.shape(), given.shape() + given.ndim());
  shape.back() = kLinearJoints;
  py::array_t<double> out(shape);
  double* to = out.mutable_data();
  const double* from = given.data();
  for (py::ssize_t row = 0; row < given.size() / kJoints; ++row) {
    const Eigen::Vector3d d = strategies::setpoint_displacement(
        made->identified, strategies::Action::impose, strategies::Iterations::one,
        Joints(from + row * kJoints));
    to = std::copy_n(d.data(), kLinearJoints, to);
  }
  return out;
}

void call_with_rows(const py::object& object, const char* function, bool is_single,
                    std::span<const double> Q, std::span<double> out) {
  const InsideComputation mark;
  const auto rows = static_cast<py::ssize_t>(Q.size()) / kJoints;
  const std::vector<py::ssize_t> shape =
      is_single ? std::vector<py::ssize_t>{kJoints} : std::vector<py::ssize_t>{rows, kJoints};
  const py::array_t<double> given(shape, Q.data());
  const py::object returned = object.attr(function)(given);
  const Doubles result = Doubles::ensure(returned);
  if (!result) throw py::error_already_set();
  if (!std::equal(shape.begin(), shape.end(), result.shape(), result.shape() + result.ndim())) {
    throw std::runtime_error("returned an array of shape " + shape_text(result) + ", expected " +
                             shape_text(given));
  }
  const std::span<const double> values(result.data(), static_cast<std::size_t>(result.size()));
  if (!std::all_of(values.begin(), values.end(), [](double x) { return std::isfinite(x); })) {
    throw std::runtime_error("returned a value that is not finite");
  }
  std::copy(values.begin(), values.end(), out.begin());
}

void bind_setup(py::module_& module) {
  const auto joints = [](const Joints& Q) { return Q; };
  py::class_<Setup>(module, "Setup", "What a strategy may know: the machine as identified.")
      .def_property_readonly("axes", &axes_of, "letters of the 5 joints; '': there is none")
      .def_property_readonly(
          "parameters", [](const Setup& s) { return s.made->parameters; },
          "keys of the scenario in SI, by name")
      .def_property_readonly(
          "sign", [](const Setup& s) { return static_cast<double>(s.made->action); },
          "+1.0 imposes the errors, -1.0 compensates them")
      .def_readonly("period", &Setup::period, "s, between two calls of step; else NaN")
      .def_property_readonly(
          "position_period", [](const Setup& s) { return s.made->identified.position_period; },
          "s, between two calls of offset")
      .def_property_readonly(
          "lower", [=](const Setup& s) { return joints(s.made->identified.lower); },
          "(5; m, rad) lower ends of the travel")
      .def_property_readonly(
          "upper", [=](const Setup& s) { return joints(s.made->identified.upper); },
          "(5; m, rad) upper ends of the travel")
      .def_property_readonly(
          "reference", [=](const Setup& s) { return joints(s.made->identified.reference); },
          "(5; m, rad) position in which the machine starts")
      .def("error", &Setup::error, py::arg("Q"),
           "Displacement of the tool centre point along X, Y and Z (..., 3; m) that the\n"
           "identified errors cause at the positions Q (..., 5; m, rad) of the axes.");
}

}  // namespace servomill::python

#include "tools/python/option_arguments.h"

#include <pybind11/stl.h>

#include "plant/vocabulary/input_error.h"

namespace servomill::python {
namespace {

namespace py = pybind11;

std::string option_of(std::string name) {
  for (char& c : name) c = c == '_' ? '-' : c;
  return "--" + name;
}

}  // namespace

std::vector<std::string> changes_of(const py::object& set) {
  if (set.is_none()) return {};
  return py::module_::import("servomill.toml")
      .attr("assignments")(set)
      .cast<std::vector<std::string>>();
}

tools::Arguments arguments_of(const std::string& word, const py::kwargs& options,
                              const std::set<std::string>& without) {
  static const std::set<std::string> kOfCommands = {"force", "help", "quiet"};
  tools::Arguments out;
  for (const auto& [key, value] : options) {
    const auto name = key.cast<std::string>();
    if (without.contains(name) || kOfCommands.contains(name)) {
      throw InputError({name}, "is an option of the command only");
    }
    const std::string option = option_of(name);
    if (value.is_none() || value.ptr() == Py_False) continue;
    if (value.ptr() == Py_True) {
      out.push_back(option);
    } else if (py::isinstance<py::dict>(value)) {
      for (const std::string& one : changes_of(py::reinterpret_borrow<py::object>(value))) {
        out.push_back(option + "=" + one);
      }
    } else if (py::isinstance<py::list>(value) || py::isinstance<py::tuple>(value)) {
      for (const py::handle one : value) out.push_back(option + "=" + std::string(py::str(one)));
    } else {
      out.push_back(option + "=" + std::string(py::str(value)));
    }
  }
  out.emplace_back("--");
  out.push_back(word);
  return out;
}

}  // namespace servomill::python

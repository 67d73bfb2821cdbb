#include "tools/python/exceptions.h"

#include <pybind11/pybind11.h>

#include <string>
#include <utility>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "sim/system/system_error.h"

namespace servomill::python {
namespace {

namespace py = pybind11;

// "--max-block" of the command line is the argument max_block here.
std::string argument_of(std::string file) {
  if (!file.starts_with("--")) return file;
  file.erase(0, 2);
  for (char& c : file) c = c == '-' ? '_' : c;
  return file;
}

void set_input_error(const InputError& error) {
  py::list faults;
  for (const Fault& fault : error.faults()) {
    faults.append(py::make_tuple(argument_of(fault.place.file), fault.place.line,
                                 fault.place.column, fault.message));
  }
  const py::object type = py::module_::import("servomill.errors").attr("InputError");
  PyErr_SetObject(type.ptr(), type(faults).ptr());
}

void translate(std::exception_ptr thrown) {
  if (!thrown) return;
  try {
    std::rethrow_exception(std::move(thrown));
  } catch (const InputError& error) {
    set_input_error(error);
  } catch (const Interrupted&) {
    PyErr_SetNone(PyExc_KeyboardInterrupt);
  } catch (const sim::system::SystemError& error) {
    const py::object type = py::module_::import("servomill.errors").attr("SystemFailed");
    PyErr_SetString(type.ptr(), error.what());
  }
}

}  // namespace

void register_exceptions() { py::register_exception_translator(&translate); }

}  // namespace servomill::python

#include "tools/python/series_arrays.h"

#include <string>
#include <vector>

namespace servomill::python {
namespace {

namespace py = pybind11;

using Sizes = std::vector<py::ssize_t>;

Sizes shape_of(std::size_t rows, const sim::records::Signal& signal) {
  Sizes shape = {static_cast<py::ssize_t>(rows)};
  if (!signal.labels.empty()) shape.push_back(static_cast<py::ssize_t>(signal.columns()));
  return shape;
}

py::array read_only(py::array array) {
  array.attr("flags").attr("writeable") = false;
  return array;
}

}  // namespace

py::dict Signals::descriptions() const {
  py::dict out;
  for (const sim::records::Signal& one : series_->signals()) {
    out[py::str(one.name)] = py::make_tuple(one.units, one.long_name, one.labels, one.scale);
  }
  return out;
}

py::array Signals::array(const std::string& name) const {
  const sim::records::Signal* signal = series_->find(name);
  if (signal == nullptr) throw py::key_error(name);
  return read_only(is_in_memory() ? view(*signal) : copy(*signal));
}

py::array Signals::view(const sim::records::Signal& signal) const {
  constexpr auto kSize = static_cast<py::ssize_t>(sizeof(double));
  const Sizes shape = shape_of(rows(), signal);
  if (rows() == 0) return py::array_t<double>(shape);
  const sim::records::ColumnTable& table = series_->table();
  const double* first = table.column(signal.offset).data();
  Sizes strides = {kSize};
  if (shape.size() > 1) {
    const bool is_alone = signal.columns() == 1;
    const auto apart = is_alone ? 0 : table.column(signal.offset + 1).data() - first;
    strides.push_back(static_cast<py::ssize_t>(apart) * kSize);
  }
  using Owner = std::shared_ptr<const sim::records::Series>;
  const py::capsule owner(new Owner(series_), [](void* held) { delete static_cast<Owner*>(held); });
  return py::array_t<double>(shape, strides, first, owner);
}

py::array Signals::copy(const sim::records::Signal& signal) const {
  const std::size_t columns = signal.columns(), count = rows();
  py::array_t<double> out(shape_of(count, signal));
  double* to = out.mutable_data();
  const sim::records::ColumnPages& pages = *series_->pages();
  std::vector<double> page;
  for (std::size_t column = 0; column < columns; ++column) {
    for (std::size_t n = 0, row = 0; row < count; ++n) {
      pages.read(signal.offset + column, n, page);
      for (const double value : page) to[row++ * columns + column] = value;
    }
  }
  return out;
}

void bind_signals(py::module_& module) {
  py::class_<Signals>(module, "Signals")
      .def("__len__", &Signals::rows)
      .def_property_readonly("is_in_memory", &Signals::is_in_memory)
      .def("descriptions", &Signals::descriptions)
      .def("array", &Signals::array, py::arg("name"));
}

}  // namespace servomill::python

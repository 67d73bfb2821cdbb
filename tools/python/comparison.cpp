#include "tools/python/comparison.h"

#include <pybind11/stl.h>

#include <string>
#include <vector>

#include "sim/model/scenario.h"
#include "sim/run/store.h"
#include "sim/run/stored_run.h"
#include "tools/python/computing.h"

namespace servomill::python {
namespace {

namespace py = pybind11;

struct Compared {
  std::string title;
  std::vector<sim::evaluation::ComparisonRow> rows;
};

py::tuple compare(const std::string& path) {
  const Compared out = computed(py::none(), [&] {
    const sim::run::StoredRun run = sim::run::read_run(path);
    return Compared{run.title, sim::evaluation::compare(run.quantities, run.cases)};
  });
  return py::make_tuple(out.title, rows_of(out.rows), sim::evaluation::format_table(out.rows));
}

// The table of lines that Python has, without tolerances.
std::string format_rows(const py::list& rows) {
  std::vector<sim::evaluation::ComparisonRow> out;
  for (const py::handle row : rows) {
    const auto field = row.cast<py::tuple>();
    const auto text = [&](std::size_t n) { return field[n].cast<std::string>(); };
    out.push_back({.case_name = text(0),
                   .quantity = text(1),
                   .axis = text(2),
                   .statistic = text(3),
                   .unit = text(6),
                   .reference = text(7),
                   .basis = text(8),
                   .sections = text(4),
                   .value = field[5].cast<double>(),
                   .note = text(9)});
  }
  return sim::evaluation::format_table(out);
}

py::object tolerance_of(const sim::evaluation::ComparisonRow& row) {
  if (!row.tolerance) return py::none();
  return py::str(sim::evaluation::tolerance_text(*row.tolerance));
}

}  // namespace

py::list rows_of(std::span<const sim::evaluation::ComparisonRow> rows) {
  py::list out;
  for (const sim::evaluation::ComparisonRow& row : rows) {
    out.append(py::make_tuple(row.case_name, row.quantity, row.axis, row.statistic, row.sections,
                              row.value, row.unit, row.reference, row.basis, row.note,
                              tolerance_of(row)));
  }
  return out;
}

void bind_comparison(py::module_& module) {
  module.def("compare", &compare, py::arg("path"));
  module.def("format_rows", &format_rows, py::arg("rows"));
}

}  // namespace servomill::python

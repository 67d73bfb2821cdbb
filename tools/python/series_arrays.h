/// Recorded signals as arrays of numpy.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>

#include "sim/records/series.h"

namespace servomill::python {

/// The signals of a recording by name, in the units of the result file (sim/records/README.md).
/// Arrays of a recording in memory are views of it that keep it alive; those of pages are copies.
class Signals {
 public:
  /// @param series  which shares the ownership of all that it belongs to
  explicit Signals(std::shared_ptr<const sim::records::Series> series)
      : series_(std::move(series)) {}

  std::size_t rows() const { return series_->rows(); }
  bool is_in_memory() const { return series_->pages() == nullptr; }
  /// Name to (units, long name, labels of the columns, name of their dimension).
  pybind11::dict descriptions() const;
  /// Shape (rows) or (rows, columns), read only. @throws KeyError
  pybind11::array array(const std::string& name) const;

 private:
  pybind11::array view(const sim::records::Signal& signal) const;
  pybind11::array copy(const sim::records::Signal& signal) const;

  std::shared_ptr<const sim::records::Series> series_;
};

void bind_signals(pybind11::module_& module);

}  // namespace servomill::python

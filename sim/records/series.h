/// Recorded signals: rows of named signals, in the units that a reader of the file sees.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sim/records/chunk_encoder.h"

namespace servomill::sim {

/// One dataset: `columns` neighbouring numbers of every row.
struct Signal {
  std::string name;       // "true_linear"
  std::string units;      // "mm"
  std::string long_name;  // what it is, for a reader who knows machines but not this program
  std::string labels;     // one letter a column ("XYZ"), or empty for a scalar
  std::string scale;      // name of the dimension ("axis_linear"), empty for a scalar
  std::size_t offset = 0;
  Storage storage = Storage::float64;
  double quantum = 0.0;  // > 0: a power of two of which all values are multiples
  std::size_t columns() const { return labels.empty() ? 1 : labels.size(); }
};

/// A table of rows. Storage grows in blocks outside of what a tick does.
class Series {
 public:
  Series() = default;
  /// @param signals  their offsets are set here, in order
  explicit Series(std::vector<Signal> signals);

  const std::vector<Signal>& signals() const { return signals_; }
  std::size_t width() const { return width_; }
  std::size_t rows() const { return width_ == 0 ? 0 : data_.size() / width_; }
  const double* row(std::size_t index) const { return data_.data() + index * width_; }
  const std::vector<double>& data() const { return data_; }

  void reserve(std::size_t rows) { data_.reserve(rows * width_); }
  /// New rows of zeros to be filled; the first of them.
  double* add_rows(std::size_t count);
  double* add_row() { return add_rows(1); }
  void assign(std::vector<double> data) { data_ = std::move(data); }

  const Signal* find(std::string_view name) const;
  /// Position in a row of channel `name`, column `label` ('\0' for a scalar), or nullopt.
  std::optional<std::size_t> column(std::string_view name, char label = '\0') const;

  double at(std::size_t row_index, std::size_t column_index) const {
    return data_[row_index * width_ + column_index];
  }

 private:
  std::vector<Signal> signals_;
  std::size_t width_ = 0;
  std::vector<double> data_;
};

}  // namespace servomill::sim

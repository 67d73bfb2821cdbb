/// Rows of numbers, kept column by column.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

namespace servomill::sim::records {

/// Rows are appended; the numbers of a column are contiguous, as evaluation and file need them.
class ColumnTable {
 public:
  explicit ColumnTable(std::size_t width = 0) : width_(width) {}
  ColumnTable(const ColumnTable& other);
  ColumnTable(ColumnTable&& other) noexcept { swap(other); }
  ColumnTable& operator=(ColumnTable other) noexcept {
    swap(other);
    return *this;
  }
  ~ColumnTable() = default;
  void swap(ColumnTable& other) noexcept;

  std::size_t width() const { return width_; }
  std::size_t rows() const { return rows_; }
  void reserve(std::size_t rows);
  /// Adds whole rows.
  void append(std::span<const double> rows);
  /// Removes all rows; their storage is reused.
  void clear() { rows_ = 0; }

  std::span<const double> column(std::size_t c) const {
    return {numbers_.get() + c * apart_, rows_};
  }
  double at(std::size_t row, std::size_t c) const { return numbers_[c * apart_ + row]; }

 private:
  std::size_t width_ = 0;
  std::size_t rows_ = 0, room_ = 0;  // rows
  std::size_t apart_ = 0;            // from one column to the next
  std::unique_ptr<double[]> numbers_;
};

}  // namespace servomill::sim::records

/// Rows of numbers as columns.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace servomill::sim::records {

/// Columns of rows, each one number after the other.
class GatheredColumns {
 public:
  /// Columns that share the lines of the cache in a row: gathered together.
  static constexpr std::size_t kNeighbours = 8;

  explicit GatheredColumns(std::size_t width) : width_(width) {}

  std::size_t groups() const { return (width_ + kNeighbours - 1) / kNeighbours; }
  /// Makes room for the rows, whose groups are then gathered, by several threads if there are.
  void begin(std::span<const double> rows);
  void gather(std::size_t group);
  /// @pre its group is gathered
  std::span<const double> column(std::size_t c) const {
    return {values_.data() + c * apart_, count_};
  }

 private:
  std::size_t width_;
  std::span<const double> rows_;
  std::size_t count_ = 0, apart_ = 0;  // rows; from one column to the next
  std::vector<double> values_;
};

}  // namespace servomill::sim::records

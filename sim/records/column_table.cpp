#include "sim/records/column_table.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace servomill::sim::records {
namespace {

// Columns begin an odd number of lines of the cache apart: a power of two apart, all of them would
// map to the same set of lines.
constexpr std::size_t kLine = 8;  // numbers

constexpr std::size_t kNeighbours = 8;  // columns that share the lines of the cache in a row

constexpr std::size_t kFirstRoom = 64;  // rows

std::size_t apart_for(std::size_t rows) { return ((rows + kLine - 1) / kLine | 1) * kLine; }

}  // namespace

ColumnTable::ColumnTable(const ColumnTable& other) : width_(other.width_) {
  reserve(other.rows_);
  for (std::size_t c = 0; c < width_; ++c) {
    const std::span<const double> from = other.column(c);
    std::copy(from.begin(), from.end(), numbers_.get() + c * apart_);
  }
  rows_ = other.rows_;
}

void ColumnTable::swap(ColumnTable& other) noexcept {
  std::swap(width_, other.width_);
  std::swap(rows_, other.rows_);
  std::swap(room_, other.room_);
  std::swap(apart_, other.apart_);
  numbers_.swap(other.numbers_);
}

void ColumnTable::reserve(std::size_t rows) {
  if (rows <= room_ || width_ == 0) return;
  const std::size_t apart = apart_for(rows);
  auto larger = std::make_unique_for_overwrite<double[]>(width_ * apart);
  for (std::size_t c = 0; c < width_; ++c) {
    const std::span<const double> old = column(c);
    std::copy(old.begin(), old.end(), larger.get() + c * apart);
  }
  numbers_ = std::move(larger);
  room_ = rows;
  apart_ = apart;
}

void ColumnTable::append(std::span<const double> rows) {
  if (rows.empty()) return;
  assert(rows.size() % width_ == 0);
  const std::size_t count = rows.size() / width_;
  if (rows_ + count > room_) reserve(std::max({rows_ + count, 2 * room_, kFirstRoom}));
  for (std::size_t first = 0; first < width_; first += kNeighbours) {
    const std::size_t last = std::min(first + kNeighbours, width_);
    for (std::size_t row = 0; row < count; ++row) {
      const double* from = rows.data() + row * width_;
      double* to = numbers_.get() + first * apart_ + rows_ + row;
      for (std::size_t c = first; c < last; ++c, to += apart_) *to = from[c];
    }
  }
  rows_ += count;
}

}  // namespace servomill::sim::records

#include "sim/records/gathered_columns.h"

#include <algorithm>
#include <cassert>

namespace servomill::sim::records {
namespace {

// Columns begin on different lines of the cache: a power of two apart, all of them would take the
// place of each other there.
constexpr std::size_t kApart = 8;

constexpr std::size_t kAhead = 16;  // rows: meanwhile a line of the cache arrives from memory

void prefetch(const double* numbers) { __builtin_prefetch(numbers); }

}  // namespace

void GatheredColumns::begin(std::span<const double> rows) {
  assert(rows.size() % width_ == 0);
  rows_ = rows;
  count_ = rows.size() / width_;
  apart_ = count_ + kApart;
  if (values_.size() < width_ * apart_) values_.resize(width_ * apart_);
}

void GatheredColumns::gather(std::size_t group) {
  const std::size_t first = group * kNeighbours, last = std::min(first + kNeighbours, width_);
  for (std::size_t row = 0; row < count_; ++row) {
    const double* from = rows_.data() + row * width_;
    if (row + kAhead < count_) prefetch(from + kAhead * width_ + first);
    double* to = values_.data() + first * apart_ + row;
    for (std::size_t c = first; c < last; ++c, to += apart_) *to = from[c];
  }
}

}  // namespace servomill::sim::records

/// Rows of a recording that belong together, as ranges: a long program has few of them.
#pragma once

#include <cstddef>
#include <vector>

namespace servomill::sim {

/// Rising numbers of rows; neighbours are kept as one range.
class RowRanges {
 public:
  struct Range {
    std::size_t begin = 0, end = 0;
  };

  /// @pre row is larger than all before
  void add(std::size_t row) {
    ++size_;
    if (!ranges_.empty() && ranges_.back().end == row) {
      ++ranges_.back().end;
    } else {
      ranges_.push_back({row, row + 1});
    }
  }

  std::size_t size() const { return size_; }

  template <class Do>
  void for_each(Do do_row) const {
    for (const auto [begin, end] : ranges_) {
      for (std::size_t row = begin; row < end; ++row) do_row(row);
    }
  }

 private:
  std::vector<Range> ranges_;
  std::size_t size_ = 0;
};

}  // namespace servomill::sim

/// Rows of a recording that belong together, as ranges: a long program has few of them.
#pragma once

#include <cstddef>
#include <vector>

namespace servomill::sim::evaluation {

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

  /// Goes through the rows, one by one.
  class Cursor {
   public:
    /// @param ranges  must outlive it
    explicit Cursor(const RowRanges& ranges) : ranges_(&ranges.ranges_) { enter(); }
    bool is_at_end() const { return range_ == ranges_->size(); }
    /// @pre of these: not at the end
    std::size_t row() const { return row_; }
    void step() {
      if (++row_ < (*ranges_)[range_].end) return;
      ++range_;
      enter();
    }

   private:
    void enter() {
      if (!is_at_end()) row_ = (*ranges_)[range_].begin;
    }
    const std::vector<Range>* ranges_;
    std::size_t range_ = 0, row_ = 0;
  };

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

}  // namespace servomill::sim::evaluation

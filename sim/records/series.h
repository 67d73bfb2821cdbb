/// Recorded signals: rows of named signals, in the units that a reader of the file sees.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/records/chunk_encoder.h"
#include "sim/records/column_table.h"

namespace servomill::sim::records {

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

/// Rows that are read by pages: some rows of one column.
class ColumnPages {
 public:
  virtual ~ColumnPages() = default;
  virtual std::size_t rows() const = 0;
  virtual std::size_t page_rows() const = 0;  // of each page but the last
  virtual void read(std::size_t column, std::size_t page, std::vector<double>& values) const = 0;
  /// The page as a ChunkEncoder made it, if it is kept so.
  virtual bool read_encoded(std::size_t column, std::size_t page,
                            std::vector<std::uint8_t>& chunk) const = 0;
};

/// A table of rows: in memory as numbers, encoded in memory or, if there are many, on a disk.
class Series {
 public:
  Series() = default;
  /// @param signals  their offsets are set here, in order
  explicit Series(std::vector<Signal> signals);
  /// Rows that stay where they are. Two pages of each column that is asked for are held, so rows
  /// are best read in their order; by one thread at a time.
  Series(std::vector<Signal> signals, std::shared_ptr<const ColumnPages> pages);

  const std::vector<Signal>& signals() const { return signals_; }
  std::size_t width() const { return width_; }
  std::vector<Storage> storage_of_columns() const;
  std::size_t rows() const { return pages_ != nullptr ? pages_->rows() : table_.rows(); }
  /// Pages that hold the rows; nullptr: they are in memory.
  const ColumnPages* pages() const { return pages_.get(); }
  const std::shared_ptr<const ColumnPages>& shared_pages() const { return pages_; }

  /// @pre of these three: in memory as numbers
  const ColumnTable& table() const { return table_; }
  void reserve(std::size_t rows) { table_.reserve(rows); }
  /// Adds whole rows, one after the other.
  void append(std::span<const double> rows) {
    assert(pages_ == nullptr);
    table_.append(rows);
  }
  /// Copy of all numbers, row after row.
  std::vector<double> by_rows() const;

  /// Signals of a recording that nobody asked for: whoever looks for one throws std::logic_error.
  void leave_out(std::vector<std::string> names) { left_out_ = std::move(names); }

  const Signal* find(std::string_view name) const;
  /// Position in a row of channel `name`, column `label` ('\0' for a scalar), or nullopt.
  std::optional<std::size_t> column(std::string_view name, char label = '\0') const;

  double at(std::size_t row_index, std::size_t column_index) const {
    if (pages_ == nullptr) return table_.at(row_index, column_index);
    const Resident& page = residents_[column_index].front();
    if (row_index - page.first < page.values.size()) return page.values[row_index - page.first];
    return at_other_page(row_index, column_index);
  }

 private:
  // A page that is held: those rows from `first` on.
  struct Resident {
    std::size_t first = 0;
    std::vector<double> values;
  };
  double at_other_page(std::size_t row_index, std::size_t column_index) const;

  std::vector<Signal> signals_;
  std::vector<std::string> left_out_;
  std::size_t width_ = 0;
  ColumnTable table_;
  std::shared_ptr<const ColumnPages> pages_;
  mutable std::vector<std::array<Resident, 2>> residents_;  // of each column, the latest first
};

}  // namespace servomill::sim::records

/// Datasets of one group that grow together, row by row.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/hdf5/hdf5_file.h"

namespace servomill::sim {

/// Names of the columns: `{"axis_linear", "XYZ", "linear axis"}`; one letter a column.
struct ColumnLabels {
  std::string name;
  std::string letters;
  std::string long_name;
};

/// One dataset: a number a row, or as many as its labels have letters.
struct Channel {
  std::string name;
  Meaning meaning;
  std::string labels;  // name of its ColumnLabels; empty: one number a row
  Storage storage = Storage::float64;
  double quantum = 0.0;  // > 0: rounded to multiples of it; a power of two halves the file
};

/// What a SeriesWriter records. The index is the dimension that all share and the first number of a
/// row; a list of probed points would have {"point", {"1", "number of the point"}}.
struct SeriesLayout {
  std::string index = "time";
  Meaning index_meaning = {"s", "time"};
  std::vector<ColumnLabels> labels;
  std::vector<Channel> channels;
  std::size_t chunk_rows = 4096;
};

/// The file must outlive the writer.
///
/// A row is a flat list of numbers: the index, then the channels in the order of the layout.
class SeriesWriter {
 public:
  /// @pre  every name is there once, every `labels` of a channel exists
  /// @throws SystemError
  SeriesWriter(Hdf5Group group, SeriesLayout layout);
  /// Writes the rest, as far as that is still possible.
  ~SeriesWriter();
  SeriesWriter(const SeriesWriter&) = delete;
  SeriesWriter& operator=(const SeriesWriter&) = delete;

  std::size_t row_width() const { return width_; }
  /// Place in a row of the first number of the channel.
  std::size_t offset_of(std::string_view channel) const;

  /// Adds a row. Neither allocates nor throws, except when it completes a block of `chunk_rows`:
  /// that is written and flushed and outlives a kill of the process.
  /// @throws SystemError; the rows of the block are then lost, the file ends with the block before
  void append(std::span<const double> row);

  /// Writes the rows of a block that is not full. Nothing can be added afterwards.
  void finish();

 private:
  struct Column {
    Hdf5Dataset dataset;
    std::size_t offset;  // in a row
    std::size_t columns;
    double quantum;
  };

  void add_channel(const Channel& channel, std::vector<Hdf5Dataset>& scales);
  void write_block();
  void gather(const Column& column, std::size_t rows);

  Hdf5Group group_;
  SeriesLayout layout_;
  std::vector<Column> columns_;  // the index first
  std::size_t width_ = 0;
  std::size_t reserved_bytes_ = 0;  // most that a block can take on the disk
  std::vector<double> block_;       // chunk_rows x width
  std::vector<double> gathered_;    // one channel of the block
  std::size_t rows_ = 0;            // in the block
  bool finished_ = false;
};

}  // namespace servomill::sim

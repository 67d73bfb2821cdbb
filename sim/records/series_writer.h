/// Datasets of one group that grow together, row by row.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/records/hdf5_group.h"
#include "sim/records/nexus.h"
#include "sim/records/series.h"
#include "sim/system/worker_thread.h"

namespace servomill::sim::records {

/// Names of the columns: `{"axis_linear", "XYZ", "linear axis"}`; one letter a column.
struct ColumnLabels {
  std::string name;
  std::string letters;
  std::string long_name;
  std::string same_as = {};  // path of the dataset that has them already; empty: none
};

/// One dataset: a number a row, or as many as its labels have letters.
struct Channel {
  std::string name;
  Meaning meaning;
  std::string labels;  // name of its ColumnLabels; empty: one number a row
  Storage storage = Storage::float64;
  std::string same_as = {};  // path of the dataset that has its numbers already; empty: none
};

/// An index whose row i is i * ticks * tick, to the bit.
struct EvenSteps {
  std::int64_t ticks;
  double tick;
};

/// Layout of a series. The index is the dimension that all share and the first number of a
/// row; a list of probed points would have {"point", {"1", "number of the point"}}.
struct SeriesLayout {
  std::string index = "time";
  Meaning index_meaning = {"s", "time"};
  std::optional<EvenSteps> index_steps = {};  // said to readers, who need not read the index then
  std::string index_same_as = {};             // as that of a channel
  std::vector<ColumnLabels> labels;
  std::vector<Channel> channels;
  Plot plot = {};  // what viewers draw; without a signal, nothing
  std::size_t chunk_rows = 16384;
  int compression = 1;       // kNoCompression to kMaxCompression
  unsigned threads = 0;      // that compress; 0: one a core; the file does not depend on it
  bool is_encoded = false;   // rows come as pages (append_pages); none can be appended
  bool is_complete = false;  // rows come all at once (append_all); likewise
};

/// The file must outlive the writer.
///
/// A row is a flat list of numbers: the index, then the channels in the order of the layout. Those
/// that are `same_as` a dataset of the file are further names of that, whose numbers are left
/// alone.
///
/// Whoever appends rows only copies them: a thread of the writer compresses and writes a block
/// while the next one fills. There are no more than these two.
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
  /// that is handed over, when the one before is written, flushed and outlives a kill of the
  /// process. (Unless the kill comes while the library splits the index of a dataset, as it does
  /// every 64 chunks or so: that spoils this dataset.)
  /// @throws SystemError if a block before could not be written; the file ends with the one before
  ///         that, and every later call throws the same
  void append(std::span<const double> row);

  /// Adds all rows, one behind the other, without a copy of them; once.
  /// @pre is_complete of the layout
  /// @throws SystemError as append
  void append_all(std::span<const double> rows);

  /// Adds all rows of pages that are encoded, a page to a chunk. Some hundred kilobytes or more of
  /// a column lie next to each other in the file, so that one signal is read without the others.
  /// @pre is_encoded of the layout, and its chunk_rows are those of a page; nothing was added yet
  /// @throws SystemError
  void append_pages(const ColumnPages& pages);

  /// Writes the rows of a block that is not full and waits for it. Nothing can be added afterwards.
  /// @throws SystemError as append
  void finish();

 private:
  struct Dataset {
    Hdf5Dataset dataset;
    std::size_t offset;  // in a row
    std::size_t columns;
    bool is_shared;  // its numbers are there already
  };
  // Columns whose numbers share the cache lines of a row: encoded by one thread.
  struct Neighbours {
    std::size_t begin, end;
    std::vector<double> gathered;  // column by column
    ChunkEncoder encoder;
  };

  Hdf5Dataset make(const Channel& channel, std::vector<Hdf5Dataset>& scales);
  void add_channel(const Channel& channel, std::vector<Hdf5Dataset>& scales);
  void allocate();
  void hand_over();
  void write_block(const double* block, std::size_t rows);
  void write_pages(Dataset& to, const ColumnPages& pages, std::size_t first, std::size_t last);
  void encode(Neighbours& columns, const double* block, std::size_t rows);

  Hdf5Group group_;
  SeriesLayout layout_;
  std::vector<Dataset> datasets_;  // the index first
  std::vector<Storage> storage_;   // of each column
  std::vector<bool> shared_;       // columns that are not written
  std::vector<Neighbours> neighbours_;
  std::vector<std::vector<std::uint8_t>> chunks_;  // of the block, column by column
  std::size_t width_ = 0;
  std::vector<double> filling_, writing_;  // chunk_rows x width
  std::size_t rows_ = 0;                   // in the block that fills
  bool finished_ = false;
  system::WorkerThread background_;  // last: its thread uses the others
};

}  // namespace servomill::sim::records

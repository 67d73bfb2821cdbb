/// Rows of a long recording, on the disk from the moment when a page of them is full.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "plant/vocabulary/scratch_file.h"
#include "sim/records/chunk_decoder.h"
#include "sim/records/page_encoder.h"
#include "sim/records/series.h"

namespace servomill::sim::records {

/// How a spool keeps its rows.
struct SpoolFormat {
  std::string folder;  // of its file
  PageFormat page = {};
};

/// Rows of a chunk so that chunks are of equal length and the last one holds little that is
/// nothing.
std::size_t even_chunk_rows(std::size_t rows);

/// Chunks are encoded as a result file holds them, so that they go there as they are. One chunk of
/// rows is in memory, however many there are. Not for several threads.
class SeriesSpool final : public ColumnPages {
 public:
  /// @throws SystemError, as all members
  SeriesSpool(const std::vector<Signal>& signals, SpoolFormat format);

  /// Adds whole rows, one behind the other.
  void append(std::span<const double> rows);
  /// Writes the rows of a chunk that is not full. Nothing can be added afterwards.
  void finish();

  /// Bytes of the chunks of all columns that are full, and the rows in them. On the disk they take
  /// less where columns are equal.
  std::uint64_t bytes() const { return bytes_; }
  std::size_t rows_on_disk() const { return pages_ * format_.chunk_rows; }

  /// @pre of these: finish()
  std::size_t rows() const override { return rows_; }
  std::size_t page_rows() const override { return format_.chunk_rows; }
  void read(std::size_t column, std::size_t page, std::vector<double>& values) const override;
  bool read_encoded(std::size_t column, std::size_t page,
                    std::vector<std::uint8_t>& chunk) const override;

 private:
  struct Chunk {
    std::uint64_t place = 0;
    std::uint32_t size = 0;
  };
  void write_page();
  std::size_t rows_in(std::size_t page) const;

  PageFormat format_;
  std::vector<Storage> storage_;  // of each column
  ScratchFile file_;
  PageEncoder encoder_;
  mutable ChunkDecoder decoder_;
  mutable std::vector<std::uint8_t> encoded_;
  std::vector<Chunk> chunks_;    // page after page, of each column
  std::vector<double> filling_;  // rows of the page that is not full
  std::uint64_t bytes_ = 0;
  std::size_t pages_ = 0, rows_ = 0;
};

}  // namespace servomill::sim::records

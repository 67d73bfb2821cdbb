/// Rows of a long recording, on the disk from the moment when a chunk of them is full.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "plant/vocabulary/scratch_file.h"
#include "sim/records/chunk_decoder.h"
#include "sim/records/chunk_encoder.h"
#include "sim/records/series.h"

namespace servomill::sim::records {

/// How a spool keeps its rows.
struct SpoolFormat {
  std::string folder;  // of its file
  std::size_t chunk_rows = 16384;
  int compression = 1;  // kNoCompression to kMaxCompression
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

  /// Bytes of the chunks that are full, and the rows in them.
  std::uint64_t bytes() const { return file_.size(); }
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
  void write_chunk(std::size_t rows);
  std::size_t rows_in(std::size_t page) const;

  SpoolFormat format_;
  std::vector<Storage> storage_;  // of each column
  ScratchFile file_;
  ChunkEncoder encoder_;
  mutable ChunkDecoder decoder_;
  mutable std::vector<std::uint8_t> encoded_;
  std::vector<Chunk> chunks_;     // page after page, of each column
  std::vector<double> filling_;   // rows of the chunk that is not full
  std::vector<double> gathered_;  // one column of it
  std::size_t pages_ = 0, rows_ = 0;
};

}  // namespace servomill::sim::records

/// Rows of a recording, encoded from the moment when a page of them is full.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "plant/vocabulary/scratch_file.h"
#include "sim/records/chunk_decoder.h"
#include "sim/records/column_table.h"
#include "sim/records/page_encoder.h"
#include "sim/records/series.h"
#include "sim/system/worker_thread.h"

namespace servomill::sim::records {

/// How a spool keeps its rows.
struct SpoolFormat {
  std::string folder;  // of its file
  PageFormat page = {};
  double most_in_memory = 0.0;  // bytes of chunks; those that come later go to the file
  bool encodes_beside = true;   // in a thread of its own
  std::vector<bool> kept = {};  // of each column: its numbers stay in memory, too; empty: of none
};

/// Rows of a chunk so that chunks are of equal length and the last one holds little that is
/// nothing.
std::size_t even_chunk_rows(std::size_t rows);

/// Chunks are encoded as a result file holds them, so that they go there as they are, while further
/// rows come. Of those that are in the file, two pages of rows are in memory, however many there
/// are. For one thread at a time.
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
  std::uint64_t bytes() const;
  std::size_t rows_encoded() const;

  /// @pre of these: finish()
  std::size_t rows() const override { return rows_; }
  std::size_t page_rows() const override { return format_.page.chunk_rows; }
  void read(std::size_t column, std::size_t page, std::vector<double>& values) const override;
  bool read_encoded(std::size_t column, std::size_t page,
                    std::vector<std::uint8_t>& chunk) const override;

 private:
  struct Chunk {
    std::uint64_t place = 0;  // in the file, or among those in memory
    std::uint32_t size = 0;
    bool is_on_disk = false;
  };
  void hand_over();
  void write_page(const ColumnTable& page);
  Chunk stored(const std::vector<std::uint8_t>& chunk);
  ScratchFile& file();
  std::size_t rows_in(std::size_t page) const;

  SpoolFormat format_;
  std::vector<Storage> storage_;        // of each column
  std::vector<std::size_t> kept_;       // columns
  std::optional<PageEncoder> encoder_;  // until finish()
  mutable ChunkDecoder decoder_;
  mutable std::vector<std::uint8_t> encoded_;
  ColumnTable filling_;              // page that is not full
  ColumnTable working_;              // page that the thread encodes
  std::optional<ScratchFile> file_;  // from the first chunk on that is written there
  std::vector<std::vector<std::uint8_t>> in_memory_;
  double bytes_stored_ = 0.0;                 // here and there
  std::vector<Chunk> chunks_;                 // page after page, of each column
  std::vector<std::vector<double>> numbers_;  // page after page, of each kept column
  std::uint64_t bytes_ = 0;
  std::size_t pages_ = 0, rows_ = 0;
  mutable std::optional<system::WorkerThread> background_;  // last: its thread uses the others
};

}  // namespace servomill::sim::records

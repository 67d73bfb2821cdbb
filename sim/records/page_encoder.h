/// Columns of a series as the chunks of a file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/records/chunk_encoder.h"

namespace servomill::sim::records {

/// How rows are encoded.
struct PageFormat {
  std::size_t chunk_rows = 16384;
  int compression = 1;  // kNoCompression to kMaxCompression
};

/// Encodes one page after the other. Columns of the same numbers and storage share a chunk,
/// which is encoded once. For one caller at a time.
class PageEncoder {
 public:
  /// @param storage  of each column
  /// @param threads  that encode; the chunks do not depend on it
  PageEncoder(std::vector<Storage> storage, const PageFormat& format, unsigned threads);

  /// @param columns  numbers of each, at most as many as a chunk holds
  void encode(std::span<const std::span<const double>> columns);
  /// The different chunks of the page.
  std::span<const std::vector<std::uint8_t>> chunks() const {
    return std::span(chunks_).first(first_.size());
  }
  /// Index of the chunk of each column.
  std::span<const std::size_t> chunk_of_columns() const { return chunk_of_; }

 private:
  using Columns = std::span<const std::span<const double>>;
  std::size_t chunk_of(Columns columns, std::size_t column);
  void encode_first(Columns columns, unsigned threads);

  std::vector<Storage> storage_;
  std::size_t chunk_rows_;
  std::vector<ChunkEncoder> encoders_;  // of each thread
  std::vector<std::size_t> first_;      // column of each chunk
  std::vector<std::size_t> chunk_of_;
  std::vector<std::vector<std::uint8_t>> chunks_;
};

}  // namespace servomill::sim::records

/// Chunks as they stand in a file, made without the library, so that several threads can.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace servomill::sim::records {

class PlaneCompressor;

/// How a number is stored.
enum class Storage : std::uint8_t { float64, float32, int32 };

std::size_t bytes_of(Storage storage);

/// Levels of compression: none to most.
inline constexpr int kNoCompression = 0, kMaxCompression = 9;

/// Makes what HDF5's own filters "shuffle" and "deflate" would make of a chunk, so that whoever
/// reads HDF5 reads it: bytes sorted by their place in a number, as a zlib stream (RFC 1950). Level
/// 0 leaves the numbers as they are. The same numbers give the same bytes. Not for several threads.
class ChunkEncoder {
 public:
  explicit ChunkEncoder(int level);
  ~ChunkEncoder();
  ChunkEncoder(ChunkEncoder&&) noexcept;

  /// Chunk of `rows` numbers, of which the first are `values`; those behind are not a number (0 as
  /// int32).
  /// @pre values.size() <= rows
  void encode(std::span<const double> values, std::size_t rows, Storage storage,
              std::vector<std::uint8_t>& chunk);

 private:
  std::unique_ptr<PlaneCompressor> compressor_;  // null: level 0
  std::vector<std::uint8_t> plain_, shuffled_;
};

}  // namespace servomill::sim::records

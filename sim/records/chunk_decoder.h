/// Reads chunks back that a ChunkEncoder made.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/records/chunk_encoder.h"

namespace servomill::sim::records {

/// Not for several threads.
class ChunkDecoder {
 public:
  ChunkDecoder();
  ~ChunkDecoder();
  ChunkDecoder(ChunkDecoder&&) noexcept;

  /// The first numbers of a chunk, as many as `values` takes.
  /// @param chunk  of `rows` numbers, as ChunkEncoder made it with that level
  /// @pre values.size() <= rows
  /// @throws std::runtime_error if the chunk is damaged
  void decode(std::span<const std::uint8_t> chunk, std::size_t rows, Storage storage, int level,
              std::span<double> values);

 private:
  struct Inflate;
  std::unique_ptr<Inflate> inflate_;
  std::vector<std::uint8_t> shuffled_;
};

}  // namespace servomill::sim::records

/// zlib streams of numbers whose bytes are sorted by their place.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <utility>
#include <vector>

struct libdeflate_compressor;

namespace servomill::sim::records {

/// Makes zlib streams (RFC 1950) of planes: the bytes of one place of all numbers. The first planes
/// hold the lowest bytes, which are zero where numbers are rounded: they are compressed once and
/// the result is reused. The same bytes give the same stream. Not for several threads.
class PlaneCompressor {
 public:
  /// @param level  1 to 9
  explicit PlaneCompressor(int level);

  /// @param bytes  whole planes of `plane` bytes
  void compress(std::span<const std::uint8_t> bytes, std::size_t plane,
                std::vector<std::uint8_t>& stream);

 private:
  using Bytes = std::span<const std::uint8_t>;
  struct FreeCompressor {
    void operator()(libdeflate_compressor* compressor) const;
  };

  void put_constant(std::uint8_t value, std::size_t count);
  void put_deflated(Bytes bytes);
  void put(Bytes bytes);

  std::unique_ptr<libdeflate_compressor, FreeCompressor> compressor_;
  std::vector<std::uint8_t> room_;  // for any stream; a new one would be filled with zeros
  std::size_t size_ = 0;            // bytes of the stream in it
  std::map<std::pair<std::uint8_t, std::size_t>, std::vector<std::uint8_t>> constants_;
};

}  // namespace servomill::sim::records

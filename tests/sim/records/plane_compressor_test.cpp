// Streams of planes: whoever reads zlib reads them, whatever the first planes hold.

#include "sim/records/plane_compressor.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include <cstdint>
#include <random>
#include <vector>

namespace servomill::sim::records::plane_compressor_test {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Planes of numbers whose lowest `constant` bytes are `value`, the others random within 4 bits.
Bytes planes(std::size_t count, std::size_t plane, std::size_t constant, std::uint8_t value = 0) {
  std::minstd_rand random(static_cast<unsigned>(plane + constant));
  Bytes out(constant * plane, value);
  while (out.size() < count * plane) out.push_back(static_cast<std::uint8_t>(random() >> 10 & 15));
  return out;
}

Bytes compressed(const Bytes& bytes, std::size_t plane, int level = 1) {
  PlaneCompressor compressor(level);
  Bytes out;
  compressor.compress(bytes, plane, out);
  return out;
}

// By zlib itself, which also compares the checksum.
Bytes inflated(const Bytes& stream, std::size_t size) {
  Bytes out(size + 1);
  uLongf length = out.size();
  EXPECT_EQ(uncompress(out.data(), &length, stream.data(), stream.size()), Z_OK);
  out.resize(length);
  return out;
}

TEST(PlaneCompressor, GivesStreamsThatZlibReads) {
  for (const std::size_t plane : {1u, 2u, 100u, 15539u, 70'000u}) {
    for (const std::size_t constant : {0u, 1u, 3u, 8u}) {
      for (const int value : {0, 7, 255}) {
        const Bytes bytes = planes(8, plane, constant, static_cast<std::uint8_t>(value));
        EXPECT_EQ(inflated(compressed(bytes, plane), bytes.size()), bytes)
            << plane << ' ' << constant << ' ' << value;
      }
    }
  }
}

TEST(PlaneCompressor, GivesStreamsThatZlibReadsAtEveryLevel) {
  const Bytes bytes = planes(8, 1000, 2);
  for (int level = 1; level <= 9; ++level) {
    EXPECT_EQ(inflated(compressed(bytes, 1000, level), bytes.size()), bytes) << level;
  }
}

TEST(PlaneCompressor, TakesHardlyAnyRoomForPlanesThatAreConstant) {
  constexpr std::size_t kPlane = 16'384, kLargest = 200;  // bytes
  EXPECT_LT(compressed(planes(8, kPlane, 8), kPlane).size(), kLargest);
  EXPECT_LT(compressed(planes(8, kPlane, 5), kPlane).size(),
            compressed(planes(3, kPlane, 0), kPlane).size() + kLargest);
}

TEST(PlaneCompressor, TakesAPlaneForConstantToItsLastByte) {
  constexpr std::size_t kPlane = 50;
  Bytes bytes = planes(4, kPlane, 4);
  for (const std::size_t place : {std::size_t{0}, kPlane - 1, kPlane, bytes.size() - 1}) {
    Bytes other = bytes;
    other[place] = 1;
    EXPECT_EQ(inflated(compressed(other, kPlane), other.size()), other) << place;
  }
}

TEST(PlaneCompressor, GivesTheSameStreamWhateverItCompressedBefore) {
  PlaneCompressor compressor(1);
  const Bytes one = planes(8, 300, 2), other = planes(8, 300, 4, 9);
  Bytes first, between, again;
  compressor.compress(one, 300, first);
  compressor.compress(other, 300, between);
  compressor.compress(one, 300, again);
  EXPECT_EQ(first, again);
  EXPECT_EQ(between, compressed(other, 300));
}

}  // namespace
}  // namespace servomill::sim::records::plane_compressor_test

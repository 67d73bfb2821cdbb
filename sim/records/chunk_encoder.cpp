#include "sim/records/chunk_encoder.h"

#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <limits>

#include "sim/records/plane_compressor.h"
#include "sim/records/transpose_bytes.h"

namespace servomill::sim::records {
namespace {

static_assert(std::endian::native == std::endian::little);  // as the types of the file are

template <typename T>
void store(std::span<const double> values, std::size_t rows, T rest,
           std::vector<std::uint8_t>& bytes) {
  bytes.resize(rows * sizeof(T));
  std::uint8_t* to = bytes.data();
  for (const double value : values) {
    const T stored = static_cast<T>(value);
    std::memcpy(to, &stored, sizeof(T));
    to += sizeof(T);
  }
  for (std::size_t i = values.size(); i < rows; ++i, to += sizeof(T)) {
    std::memcpy(to, &rest, sizeof(T));
  }
}

// Byte b of number i goes to place b * count + i.
template <std::size_t kSize>
void shuffle(const std::uint8_t* from, std::size_t count, std::uint8_t* to) {
  std::size_t i = 0;
  if constexpr (kSize == sizeof(std::uint64_t)) {
    for (std::array<std::uint64_t, 8> eight; i + 8 <= count; i += 8) {
      std::memcpy(eight.data(), from + i * kSize, sizeof(eight));
      transpose_bytes(eight);
      for (std::size_t b = 0; b < kSize; ++b) std::memcpy(to + b * count + i, &eight[b], kSize);
    }
  }
  for (; i < count; ++i) {
    for (std::size_t b = 0; b < kSize; ++b) to[b * count + i] = from[i * kSize + b];
  }
}

}  // namespace

std::size_t bytes_of(Storage storage) { return storage == Storage::float64 ? 8 : 4; }

ChunkEncoder::ChunkEncoder(int level) {
  assert(level >= kNoCompression && level <= kMaxCompression);
  if (level != kNoCompression) compressor_ = std::make_unique<PlaneCompressor>(level);
}

ChunkEncoder::~ChunkEncoder() = default;
ChunkEncoder::ChunkEncoder(ChunkEncoder&&) noexcept = default;

void ChunkEncoder::encode(std::span<const double> values, std::size_t rows, Storage storage,
                          std::vector<std::uint8_t>& chunk) {
  assert(values.size() <= rows);
  // a full chunk of numbers that are kept as they are is shuffled where it lies
  const bool is_plain = compressor_ && storage == Storage::float64 && values.size() == rows;
  const auto* bytes_of_numbers = reinterpret_cast<const std::uint8_t*>(values.data());
  std::vector<std::uint8_t>& plain = compressor_ ? plain_ : chunk;
  switch (storage) {
    case Storage::float64:
      if (!is_plain) store(values, rows, std::numeric_limits<double>::quiet_NaN(), plain);
      break;
    case Storage::float32:
      store(values, rows, std::numeric_limits<float>::quiet_NaN(), plain);
      break;
    case Storage::int32:
      store(values, rows, std::int32_t{0}, plain);
      break;
  }
  if (!compressor_) return;
  shuffled_.resize(rows * bytes_of(storage));
  if (bytes_of(storage) == 8) {
    shuffle<8>(is_plain ? bytes_of_numbers : plain_.data(), rows, shuffled_.data());
  } else {
    shuffle<4>(plain_.data(), rows, shuffled_.data());
  }
  compressor_->compress(shuffled_, rows, chunk);
}

}  // namespace servomill::sim::records

#include "sim/records/chunk_encoder.h"

#include <libdeflate.h>

#include <bit>
#include <cassert>
#include <cstring>
#include <limits>
#include <new>

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
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t b = 0; b < kSize; ++b) to[b * count + i] = from[i * kSize + b];
  }
}

}  // namespace

std::size_t bytes_of(Storage storage) { return storage == Storage::float64 ? 8 : 4; }

struct ChunkEncoder::Deflate {
  explicit Deflate(int level) : compressor(libdeflate_alloc_compressor(level)) {
    if (compressor == nullptr) throw std::bad_alloc();
  }
  ~Deflate() { libdeflate_free_compressor(compressor); }
  Deflate(const Deflate&) = delete;
  Deflate& operator=(const Deflate&) = delete;
  libdeflate_compressor* compressor;
};

ChunkEncoder::ChunkEncoder(int level) {
  assert(level >= kNoCompression && level <= kMaxCompression);
  if (level != kNoCompression) deflate_ = std::make_unique<Deflate>(level);
}

ChunkEncoder::~ChunkEncoder() = default;
ChunkEncoder::ChunkEncoder(ChunkEncoder&&) noexcept = default;

void ChunkEncoder::encode(std::span<const double> values, std::size_t rows, Storage storage,
                          std::vector<std::uint8_t>& chunk) {
  assert(values.size() <= rows);
  std::vector<std::uint8_t>& plain = deflate_ ? plain_ : chunk;
  switch (storage) {
    case Storage::float64:
      store(values, rows, std::numeric_limits<double>::quiet_NaN(), plain);
      break;
    case Storage::float32:
      store(values, rows, std::numeric_limits<float>::quiet_NaN(), plain);
      break;
    case Storage::int32:
      store(values, rows, std::int32_t{0}, plain);
      break;
  }
  if (!deflate_) return;
  shuffled_.resize(plain_.size());
  if (bytes_of(storage) == 8) {
    shuffle<8>(plain_.data(), rows, shuffled_.data());
  } else {
    shuffle<4>(plain_.data(), rows, shuffled_.data());
  }
  chunk.resize(libdeflate_zlib_compress_bound(deflate_->compressor, shuffled_.size()));
  const std::size_t size = libdeflate_zlib_compress(deflate_->compressor, shuffled_.data(),
                                                    shuffled_.size(), chunk.data(), chunk.size());
  assert(size > 0);
  chunk.resize(size);
}

}  // namespace servomill::sim::records

#include "sim/records/chunk_decoder.h"

#include <libdeflate.h>

#include <array>
#include <bit>
#include <cassert>
#include <cstring>
#include <new>
#include <stdexcept>

#include "sim/records/transpose_bytes.h"

namespace servomill::sim::records {
namespace {

static_assert(std::endian::native == std::endian::little);  // as the types of the file are

// Number i of `count`, whose byte b lies at place b * stride + i * step.
template <typename T>
T number_at(const std::uint8_t* bytes, std::size_t i, std::size_t stride, std::size_t step) {
  std::array<std::uint8_t, sizeof(T)> of_number;
  for (std::size_t b = 0; b < sizeof(T); ++b) of_number[b] = bytes[b * stride + i * step];
  return std::bit_cast<T>(of_number);
}

template <typename T>
void load(const std::uint8_t* bytes, std::size_t rows, bool is_shuffled, std::span<double> values) {
  const std::size_t stride = is_shuffled ? rows : 1, step = is_shuffled ? 1 : sizeof(T);
  std::size_t i = 0;
  if constexpr (sizeof(T) == sizeof(std::uint64_t)) {
    for (std::array<std::uint64_t, 8> eight; is_shuffled && i + 8 <= values.size(); i += 8) {
      for (std::size_t b = 0; b < 8; ++b) std::memcpy(&eight[b], bytes + b * rows + i, 8);
      transpose_bytes(eight);
      std::memcpy(&values[i], eight.data(), sizeof(eight));
    }
  }
  for (; i < values.size(); ++i) {
    values[i] = static_cast<double>(number_at<T>(bytes, i, stride, step));
  }
}

}  // namespace

struct ChunkDecoder::Inflate {
  Inflate() : decompressor(libdeflate_alloc_decompressor()) {
    if (decompressor == nullptr) throw std::bad_alloc();
  }
  ~Inflate() { libdeflate_free_decompressor(decompressor); }
  Inflate(const Inflate&) = delete;
  Inflate& operator=(const Inflate&) = delete;
  libdeflate_decompressor* decompressor;
};

ChunkDecoder::ChunkDecoder() : inflate_(std::make_unique<Inflate>()) {}
ChunkDecoder::~ChunkDecoder() = default;
ChunkDecoder::ChunkDecoder(ChunkDecoder&&) noexcept = default;

void ChunkDecoder::decode(std::span<const std::uint8_t> chunk, std::size_t rows, Storage storage,
                          int level, std::span<double> values) {
  assert(values.size() <= rows);
  const bool is_compressed = level != kNoCompression;
  const std::size_t size = rows * bytes_of(storage);
  const std::uint8_t* bytes = chunk.data();
  bool is_whole = chunk.size() == size;
  if (is_compressed) {
    shuffled_.resize(size);
    is_whole = libdeflate_zlib_decompress(inflate_->decompressor, chunk.data(), chunk.size(),
                                          shuffled_.data(), size, nullptr) == LIBDEFLATE_SUCCESS;
    bytes = shuffled_.data();
  }
  if (!is_whole) throw std::runtime_error("a chunk of recorded signals is damaged");
  switch (storage) {
    case Storage::float64:
      return load<double>(bytes, rows, is_compressed, values);
    case Storage::float32:
      return load<float>(bytes, rows, is_compressed, values);
    case Storage::int32:
      return load<std::int32_t>(bytes, rows, is_compressed, values);
  }
}

}  // namespace servomill::sim::records

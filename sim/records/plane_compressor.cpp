#include "sim/records/plane_compressor.h"

#include <libdeflate.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <new>
#include <stdexcept>

namespace servomill::sim::records {
namespace {

constexpr std::array<std::uint8_t, 2> kHeader = {0x78, 0x01};  // RFC 1950, 2.2: window of 32 KiB
constexpr std::array<std::uint8_t, 5> kLastBlock = {1, 0, 0, 0xff, 0xff};  // stored, empty
constexpr std::size_t kOverhead = 64;  // bytes, more than header, checksum and block headers take

// Bytes of the planes at the beginning that are equal to the first byte.
std::size_t equal_planes(std::span<const std::uint8_t> bytes, std::size_t plane) {
  std::size_t equal = 0;
  while (equal < bytes.size() && bytes[equal] == bytes[0] &&
         std::memcmp(&bytes[equal], &bytes[equal] + 1, plane - 1) == 0) {
    equal += plane;
  }
  return equal;
}

// Blocks of equal bytes that end at the end of a byte and are not the last ones.
std::vector<std::uint8_t> deflated_constant(std::uint8_t value, std::size_t count) {
  z_stream stream = {};
  constexpr int kRaw = -15;  // window, without a header
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kRaw, 8, Z_DEFAULT_STRATEGY) != Z_OK) {
    throw std::bad_alloc();
  }
  std::vector<std::uint8_t> from(count, value), to(deflateBound(&stream, count) + kOverhead);
  stream.next_in = from.data();
  stream.avail_in = static_cast<uInt>(from.size());
  stream.next_out = to.data();
  stream.avail_out = static_cast<uInt>(to.size());
  const int status = deflate(&stream, Z_FULL_FLUSH);
  to.resize(stream.total_out);
  deflateEnd(&stream);
  if (status != Z_OK) throw std::logic_error("zlib does not deflate a constant");
  return to;
}

}  // namespace

void PlaneCompressor::FreeCompressor::operator()(libdeflate_compressor* compressor) const {
  libdeflate_free_compressor(compressor);
}

PlaneCompressor::PlaneCompressor(int level) : compressor_(libdeflate_alloc_compressor(level)) {
  if (compressor_ == nullptr) throw std::bad_alloc();
}

void PlaneCompressor::compress(Bytes bytes, std::size_t plane, std::vector<std::uint8_t>& stream) {
  assert(plane > 0 && bytes.size() % plane == 0);
  const std::size_t most =
      libdeflate_deflate_compress_bound(compressor_.get(), bytes.size()) + kOverhead;
  if (room_.size() < most) room_.resize(most);
  size_ = 0;
  put(kHeader);
  const std::size_t equal = equal_planes(bytes, plane);
  if (equal > 0) put_constant(bytes[0], equal);
  if (equal < bytes.size()) {
    put_deflated(bytes.subspan(equal));
  } else {
    put(kLastBlock);
  }
  const std::uint32_t sum = libdeflate_adler32(1, bytes.data(), bytes.size());
  put(std::array{static_cast<std::uint8_t>(sum >> 24), static_cast<std::uint8_t>(sum >> 16),
                 static_cast<std::uint8_t>(sum >> 8), static_cast<std::uint8_t>(sum)});
  stream.assign(room_.begin(), room_.begin() + static_cast<std::ptrdiff_t>(size_));
}

void PlaneCompressor::put_constant(std::uint8_t value, std::size_t count) {
  std::vector<std::uint8_t>& deflated = constants_[{value, count}];
  if (deflated.empty()) deflated = deflated_constant(value, count);
  put(deflated);
}

void PlaneCompressor::put_deflated(Bytes bytes) {
  const std::size_t size = libdeflate_deflate_compress(
      compressor_.get(), bytes.data(), bytes.size(), room_.data() + size_, room_.size() - size_);
  if (size == 0) throw std::logic_error("a chunk grows beyond what libdeflate names as its bound");
  size_ += size;
}

void PlaneCompressor::put(Bytes bytes) {
  if (size_ + bytes.size() > room_.size()) throw std::logic_error("a chunk grows beyond its room");
  std::copy(bytes.begin(), bytes.end(), room_.begin() + static_cast<std::ptrdiff_t>(size_));
  size_ += bytes.size();
}

}  // namespace servomill::sim::records

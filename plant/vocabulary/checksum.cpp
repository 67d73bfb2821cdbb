#include "plant/vocabulary/checksum.h"

#include <boost/crc.hpp>

#include "plant/vocabulary/stored_text.h"

namespace servomill {
namespace {

// ECMA-182, reflected, as xz has it (CRC-64/XZ): `xz --check=crc64` and libraries give the same
// number.
constexpr std::uint64_t kPolynomial = 0x42F0E1EBA9EA3693;
using Crc = boost::crc_optimal<64, kPolynomial, ~std::uint64_t{0}, ~std::uint64_t{0}, true, true>;

}  // namespace

std::uint64_t crc64(std::string_view bytes) {
  Crc crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

std::uint64_t crc64_in_pieces(const StoredText& text) {
  Crc crc;
  text.each_piece([&](std::string_view piece) { crc.process_bytes(piece.data(), piece.size()); });
  return crc.checksum();
}

}  // namespace servomill

/// Exchange of rows and columns of eight numbers of eight bytes.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace servomill::sim::records {

// Pairs of rows that lie kApart from each other exchange squares of kApart x kApart bytes.
template <std::size_t kApart>
void exchange(std::array<std::uint64_t, 8>& rows, std::uint64_t lower) {
#pragma GCC unroll 8
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if ((i & kApart) != 0) continue;
    const std::uint64_t exchanged = ((rows[i] >> (8 * kApart)) ^ rows[i + kApart]) & lower;
    rows[i + kApart] ^= exchanged;
    rows[i] ^= exchanged << (8 * kApart);
  }
}

/// Byte b of number i becomes byte i of number b.
/// Source: H. S. Warren, Hacker's Delight, 2nd ed., 2013, section 7-3, with bytes in place of bits.
inline void transpose_bytes(std::array<std::uint64_t, 8>& rows) {
  exchange<4>(rows, 0x00000000ffffffff);
  exchange<2>(rows, 0x0000ffff0000ffff);
  exchange<1>(rows, 0x00ff00ff00ff00ff);
}

}  // namespace servomill::sim::records

/// Checksums of files.
#pragma once

#include <cstdint>
#include <string_view>

namespace servomill {

class StoredText;

/// CRC-64 of ECMA-182, as xz takes it.
std::uint64_t crc64(std::string_view bytes);
/// The same of a long text.
std::uint64_t crc64_in_pieces(const StoredText& text);

}  // namespace servomill

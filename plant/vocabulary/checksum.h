/// Checksums of files.
#pragma once

#include <cstdint>
#include <string_view>

namespace servomill {

/// CRC-64 of ECMA-182, as xz takes it.
std::uint64_t crc64(std::string_view bytes);

}  // namespace servomill

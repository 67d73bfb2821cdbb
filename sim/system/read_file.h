/// Text files of the user.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/user_file.h"

namespace servomill {
class StoredText;
}  // namespace servomill

namespace servomill::sim::system {

/// The bytes of a file, without a byte-order mark (UTF-8).
/// @param at    where the file was named; without a file name: the file itself
/// @param what  "program", "machine", ...
/// @param most  bytes that it may hold
/// @throws InputError if it cannot be read
std::string read_file(const std::string& path, const Place& at, std::string_view what,
                      std::uintmax_t most = kMaxBytesOfFile);

/// The same of a file that may be long.
StoredText stored_file(const std::string& path, const Place& at, std::string_view what);

}  // namespace servomill::sim::system

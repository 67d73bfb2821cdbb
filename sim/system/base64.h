/// Bytes as text of a document.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace servomill::sim::system {

/// Base64 of RFC 4648, padded, in one line.
std::string base64(std::string_view bytes);

/// The bytes; nothing if the text is not what base64() writes.
std::optional<std::string> from_base64(std::string_view text);

}  // namespace servomill::sim::system

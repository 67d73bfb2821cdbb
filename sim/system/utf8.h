/// Characters of texts in UTF-8 (RFC 3629).
#pragma once

#include <cstddef>
#include <string_view>

namespace servomill::sim::system {

/// Length in bytes of the character that a text begins with (1 to 4); 0 if its bytes are not UTF-8:
/// a stray or missing continuation byte, an overlong form, a surrogate, beyond U+10FFFF.
/// @pre the text is not empty
std::size_t utf8_length(std::string_view text);

/// Start of the character that holds the byte at `index`.
/// @pre index < text.size(), and the text is UTF-8
std::size_t utf8_start(std::string_view text, std::size_t index);

}  // namespace servomill::sim::system

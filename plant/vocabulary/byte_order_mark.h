/// The three bytes that some editors write at the begin of a text in UTF-8. They mean nothing.
#pragma once

#include <string_view>

namespace servomill {

inline constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

}  // namespace servomill

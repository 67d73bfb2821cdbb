/// Numbers of things in messages.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <string_view>

namespace servomill::sim::system {

/// "1 block", "2 blocks", "0 blocks".
inline std::string counted(std::size_t count, std::string_view singular) {
  return fmt::format("{} {}{}", count, singular, count == 1 ? "" : "s");
}

}  // namespace servomill::sim::system

/// Numbers of things in messages.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace servomill::sim::system {

/// "1 block", "2 blocks", "0 blocks".
inline std::string counted(std::size_t count, std::string_view singular) {
  return fmt::format("{} {}{}", count, singular, count == 1 ? "" : "s");
}

/// "line 3", "lines 3, 7, 12, ...".
inline std::string line_numbers(std::span<const int> lines) {
  constexpr std::size_t kMax = 5;
  std::string out = lines.size() == 1 ? "line" : "lines";
  for (std::size_t i = 0; i < lines.size() && i < kMax; ++i) {
    out += fmt::format("{} {}", i == 0 ? "" : ",", lines[i]);
  }
  return lines.size() > kMax ? out + ", ..." : out;
}

}  // namespace servomill::sim::system

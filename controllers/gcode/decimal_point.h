/// Lengths and angles that are written without a decimal point.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace servomill::controllers {

enum class DecimalPoint : std::uint8_t {
  unset,       // as the reader has it; where that depends on a parameter of the control: refused
  calculator,  // X1000 = 1000 mm
  increments   // X1000 = 1000 least input increments: 1 mm, 0.1 inch, 1 deg
};
inline constexpr std::array<std::string_view, 3> kDecimalPoints = {"unset", "calculator",
                                                                   "increments"};

}  // namespace servomill::controllers

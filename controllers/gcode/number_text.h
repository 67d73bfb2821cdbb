/// Numbers as programs hold them: fixed point, without exponents and trailing zeros.
#pragma once

#include <string>

namespace servomill::controllers {

/// With so many decimals at most: "10.5", "0".
std::string fixed_text(double x, int decimals);

/// With twelve significant digits at most.
std::string significant_text(double x);

}  // namespace servomill::controllers

/// Temperatures at the edges: K inside, degC for a reader.
#pragma once

namespace servomill {

inline constexpr double kIcePoint = 273.15;  // K, 0 degC

/// @param degC  temperature as written
constexpr double kelvin(double degC) { return degC + kIcePoint; }
/// @param T  K
constexpr double celsius(double T) { return T - kIcePoint; }

}  // namespace servomill

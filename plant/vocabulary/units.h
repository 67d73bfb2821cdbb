/// Units at the edges. Inside, everything is SI: m, rad, s, kg, N, A. A value with a unit is
/// written `0.5 * mm`, a value for a reader `x / mm`. Nothing else in the program converts units.
#pragma once

#include <numbers>

namespace servomill {

inline constexpr double mm = 1e-3;
inline constexpr double um = 1e-6;
inline constexpr double nm = 1e-9;
inline constexpr double inch = 25.4e-3;
inline constexpr double deg = std::numbers::pi / 180.0;
inline constexpr double urad = 1e-6;
inline constexpr double ms = 1e-3;
inline constexpr double us = 1e-6;
inline constexpr double minute = 60.0;
inline constexpr double mm_per_min = mm / minute;
inline constexpr double m_per_min = 1.0 / minute;
inline constexpr double deg_per_min = deg / minute;
inline constexpr double rpm = 2.0 * std::numbers::pi / minute;

}  // namespace servomill

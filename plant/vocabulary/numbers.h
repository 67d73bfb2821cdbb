/// The words of a formula that is written once and computed with doubles or with lanes (pack.h).
#pragma once

#include <cmath>

namespace servomill {

/// A stored number (double, LaneArray) as one to compute with (double, Pack).
template <class Number, class Stored>
Number value(const Stored& stored) {
  return Number(stored);
}
/// The way back.
inline void put(double& to, double number) { to = number; }

inline double fma(double a, double b, double c) { return a * b + c; }
inline double select(bool mask, double yes, double no) { return mask ? yes : no; }
/// For a number and NaN the result is the second argument, as the processor does it for lanes.
inline double min(double a, double b) { return a < b ? a : b; }
inline double max(double a, double b) { return a > b ? a : b; }
inline double abs(double a) { return std::fabs(a); }
/// The next whole number, ties to even.
inline double nearbyint(double a) { return std::nearbyint(a); }

/// Within [low, high]; NaN stays.
template <class Number>
Number limited_to(const Number& low, const Number& high, const Number& a) {
  return min(high, max(low, a));
}

}  // namespace servomill

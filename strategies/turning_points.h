/// Turning points of a coordinate along a way.
#pragma once

#include <functional>
#include <vector>

namespace servomill::strategies {

/// Shares of the way between `from` and `to`, both excluded, at which x reverses, rising.
/// Reversals by less than 0.1 nm or 0.1 nrad are none.
/// @param x      coordinate (m, rad) at a share of the way, continuous
/// @param steps  into which the way is divided, >= 1; two reversals within one may be missed
std::vector<double> turning_points(const std::function<double(double)>& x, double from, double to,
                                   int steps);

}  // namespace servomill::strategies

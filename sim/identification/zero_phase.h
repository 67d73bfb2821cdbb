/// Low-pass filter without phase: a Butterworth filter run forwards and backwards.
#pragma once

#include <span>
#include <vector>

namespace servomill::sim::identification {

/// Applies a Butterworth low-pass of even order (bilinear transform, with its corner at the
/// frequency itself) in both directions: the corner has half the amplitude then (-6 dB). At both
/// ends the signal is continued by its point reflection.
/// @param corner  share of the sampling rate, within (0, 0.5)
/// @param order   2, 4, 6, ...
std::vector<double> zero_phase(std::span<const double> signal, double corner, int order = 4);

/// Central differences, one-sided at the ends.
std::vector<double> derivative(std::span<const double> signal, double period);

}  // namespace servomill::sim::identification

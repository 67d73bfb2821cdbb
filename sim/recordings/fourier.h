/// Discrete Fourier transform of one record.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

namespace servomill::sim::recordings {

/// First `lines` lines of the discrete Fourier transform, for any number of samples N:
///     X(k) = sum over n of x(n) exp(-2 pi i k n / N)
/// by its definition, with the factors from a table of one turn: the work is N x lines. The mean is
/// taken off before, so that the rounding of an offset does not reach the lines of a small signal.
/// @pre lines <= N
std::vector<std::complex<double>> fourier_lines(std::span<const double> samples, std::size_t lines);

}  // namespace servomill::sim::recordings

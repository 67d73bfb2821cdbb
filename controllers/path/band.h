/// Symmetric positive definite systems whose matrix is a band.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <span>

namespace servomill::controllers {

/// Solves A x = b by L D L^T, in place.
/// @param band  rows of the upper half: band[k][i] = A(k, k+i), 0 beyond the last column; destroyed
/// @param x     in b, out the solution; numbers or vectors
template <std::size_t width, class Value>
void solve_band(std::span<std::array<double, width>> band, std::span<Value> x) {
  assert(band.size() == x.size());
  const std::size_t n = band.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::array<double, width>& row = band[k];
    const std::size_t end = std::min(width, n - k);
    const double inverse = 1.0 / row[0];
    for (std::size_t i = 1; i < end; ++i) {
      const double L = row[i] * inverse;
      for (std::size_t j = i; j < width; ++j) band[k + i][j - i] -= L * row[j];
      x[k + i] -= L * x[k];
    }
    for (double& value : row) value *= inverse;
    row[0] = inverse;
  }
  for (std::size_t k = n; k-- > 0;) {
    x[k] *= band[k][0];
    for (std::size_t i = 1; i < std::min(width, n - k); ++i) x[k] -= band[k][i] * x[k + i];
  }
}

}  // namespace servomill::controllers

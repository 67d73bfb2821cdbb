#include "sim/limits/mean_derivative.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

namespace servomill::sim::limits {

MeanDerivative mean_derivative(std::span<const double> t, std::span<const double> x, int order,
                               std::size_t step, std::size_t k, double quantum) {
  assert(order >= 0 && order <= kMaxOrder && k + static_cast<std::size_t>(order) * step < t.size());
  constexpr std::array<double, kMaxOrder + 1> kFactorial = {1.0, 1.0, 2.0, 6.0};
  const auto nodes = static_cast<std::size_t>(order) + 1;
  const auto at = [&](std::size_t i) { return k + i * step; };
  MeanDerivative out;
  // Differences from the first sample: large positions would cost digits.
  const double origin = x[k];
  for (std::size_t i = 0; i < nodes; ++i) {
    double product = 1.0;
    for (std::size_t j = 0; j < nodes; ++j) {
      if (j != i) product *= t[at(i)] - t[at(j)];
    }
    out.value += (x[at(i)] - (order > 0 ? origin : 0.0)) / product;
    out.floor += 0.5 * quantum / std::abs(product);
  }
  const double factorial = kFactorial[static_cast<std::size_t>(order)];
  out.value *= factorial;
  out.floor *= factorial;
  out.time = 0.5 * (t[k] + t[at(nodes - 1)]);
  return out;
}

namespace {

// True if all values are whole multiples of q, but for their own rounding.
bool are_multiples(std::span<const double> x, double q, double largest) {
  const double rounding = 4.0 * std::numeric_limits<double>::epsilon() * largest / q;
  constexpr double kMaxRounding = 0.01;  // of a step: rounding beyond it proves nothing
  if (rounding > kMaxRounding) return false;
  return std::all_of(x.begin(), x.end(), [&](double value) {
    const double steps = value / q;
    return std::abs(steps - std::round(steps)) <= rounding;
  });
}

// True if the signal trembles by steps of q, as rounding makes it: fourth differences, which are
// small in a smooth motion, change their sign from one sample to the next. A motion whose positions
// happen to be multiples of q, such as k^2 a T^2 / 2, bends in many samples and trembles in few,
// where its acceleration jumps.
bool trembles(std::span<const double> x, double q) {
  constexpr double kAlmost = 0.9;     // of a step
  constexpr std::size_t kFewest = 3;  // turns
  constexpr std::size_t kShare = 5;   // bends for each turn
  const auto fourth = [&](std::size_t i) {
    return x[i] - 4.0 * x[i + 1] + 6.0 * x[i + 2] - 4.0 * x[i + 3] + x[i + 4];
  };
  std::size_t bends = 0, turns = 0;
  for (std::size_t i = 0; i + 5 < x.size(); ++i) {
    const double now = fourth(i), next = fourth(i + 1);
    if (std::abs(x[i] - 2.0 * x[i + 1] + x[i + 2]) > kAlmost * q) ++bends;
    if (now * next < 0.0 && std::min(std::abs(now), std::abs(next)) > kAlmost * q) ++turns;
  }
  return turns >= std::max(kFewest, bends / kShare);
}

// The largest power of two of which all values are whole multiples, as recorders round them.
double binary_step(std::span<const double> x) {
  int lowest = std::numeric_limits<int>::max();
  for (const double value : x) {
    if (value == 0.0) continue;
    constexpr int kDigits = std::numeric_limits<double>::digits;
    int exponent = 0;
    const double fraction = std::frexp(std::abs(value), &exponent);
    const auto bits = static_cast<std::uint64_t>(std::ldexp(fraction, kDigits));
    lowest = std::min(lowest, exponent - kDigits + std::countr_zero(bits));
  }
  return std::ldexp(1.0, lowest);
}

}  // namespace

double quantum_of(std::span<const double> x) {
  double largest = 0.0, least_change = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < x.size(); ++i) {
    largest = std::max(largest, std::abs(x[i]));
    const double change = i > 0 ? std::abs(x[i] - x[i - 1]) : 0.0;
    if (change > 0.0) least_change = std::min(least_change, change);
  }
  const double rounding = std::numeric_limits<double>::epsilon() * largest;
  if (!(least_change < std::numeric_limits<double>::infinity())) return rounding;
  // Differences have the rounding of large values: the step follows from the largest value.
  const double step = largest / std::max(1.0, std::round(largest / least_change));
  if (are_multiples(x, step, largest) && trembles(x, step)) return step;
  constexpr int kCoarsest = 3, kFinest = 15;  // decimals, before and behind the point
  for (int decimals = -kCoarsest; decimals <= kFinest; ++decimals) {
    const double q = std::pow(10.0, -decimals);
    const bool is_fine = q <= least_change * (1.0 + 1e-6);
    if (is_fine && are_multiples(x, q, largest) && trembles(x, q)) return q;
  }
  const double binary = binary_step(x);
  return binary > 4.0 * rounding && trembles(x, binary) ? binary : rounding;
}

}  // namespace servomill::sim::limits

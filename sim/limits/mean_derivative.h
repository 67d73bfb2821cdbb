/// Derivatives of a sampled signal as means over windows, with what its resolution adds.
///
/// n! times the divided difference over n + 1 samples is the mean of the n-th derivative, weighted
/// with a B-spline M over these instants, which is positive and has the integral 1:
///
///     n! x[t_0, ..., t_n] = integral of x^(n)(t) M(t; t_0, ..., t_n) dt                        (1)
///
/// Hence a motion within its limits gives no mean beyond them, at any sampling, and no smoothing is
/// needed. Samples rounded to steps of q are off by q/2 at most, their mean by
///
///     n! q/2 sum_i 1 / |product over j != i of (t_i - t_j)|                                    (2)
///
/// which falls with the window to the power n.
///
/// Source: C. de Boor, "A Practical Guide to Splines", Springer 2001, chapters I and IX.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace servomill::sim::limits {

struct MeanDerivative {
  double value = 0.0;  // per s^n
  double floor = 0.0;  // by which the resolution may change it
  double time = 0.0;   // s, middle of its window
};

/// Largest n.
inline constexpr int kMaxOrder = 3;

/// The mean over the samples k, k + step, ..., k + order step. Order 0: the sample itself.
/// @param t     s, ascending
/// @param quantum  of x
/// @pre k + order step < t.size(), 0 <= order <= kMaxOrder
MeanDerivative mean_derivative(std::span<const double> t, std::span<const double> x, int order,
                               std::size_t step, std::size_t k, double quantum);

/// Step between the values of a signal: that of decimals or of an encoder whose multiples all
/// values are; else the rounding of double precision.
double quantum_of(std::span<const double> x);

}  // namespace servomill::sim::limits

#include "controllers/servo/filters.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace servomill::controllers {
namespace {

// Polynomial in p = s / w0.
struct Polynomial {
  double c0, c1, c2;
};

// 1 / tan(w0 T/2): p becomes this times (z - 1) / (z + 1).
// Bilinear transform, prewarped at f: gain and phase there are those of the continuous filter.
double scale(double f, double T) {
  assert(can_filter(f, T));
  return 1.0 / std::tan(std::numbers::pi * f * T);
}

Biquad first_order(const Polynomial& num, const Polynomial& den, double c) {
  const double a0 = den.c0 + den.c1 * c;
  return {.b0 = (num.c0 + num.c1 * c) / a0,
          .b1 = (num.c0 - num.c1 * c) / a0,
          .b2 = 0.0,
          .a1 = (den.c0 - den.c1 * c) / a0,
          .a2 = 0.0};
}

Biquad second_order(const Polynomial& num, const Polynomial& den, double c) {
  const double a0 = den.c0 + den.c1 * c + den.c2 * c * c;
  return {.b0 = (num.c0 + num.c1 * c + num.c2 * c * c) / a0,
          .b1 = 2.0 * (num.c0 - num.c2 * c * c) / a0,
          .b2 = (num.c0 - num.c1 * c + num.c2 * c * c) / a0,
          .a1 = 2.0 * (den.c0 - den.c2 * c * c) / a0,
          .a2 = (den.c0 - den.c1 * c + den.c2 * c * c) / a0};
}

}  // namespace

Biquad notch(double f, double zeta_num, double zeta_den, double T) {
  assert(zeta_num >= 0.0 && zeta_den > 0.0);
  return second_order({1.0, 2.0 * zeta_num, 1.0}, {1.0, 2.0 * zeta_den, 1.0}, scale(f, T));
}

Biquad low_pass(double f, double T) {
  return first_order({1.0, 0.0, 0.0}, {1.0, 1.0, 0.0}, scale(f, T));
}

Biquad low_pass(double f, double zeta, double T) {
  assert(zeta > 0.0);
  return second_order({1.0, 0.0, 0.0}, {1.0, 2.0 * zeta, 1.0}, scale(f, T));
}

// Prewarped at the geometric mean, where the phase is greatest.
Biquad lead_lag(double f_zero, double f_pole, double T) {
  assert(can_filter(f_zero, T) && can_filter(f_pole, T));
  const double f = std::sqrt(f_zero * f_pole);
  return first_order({1.0, f / f_zero, 0.0}, {1.0, f / f_pole, 0.0}, scale(f, T));
}

std::complex<double> response(const Biquad& c, double w_T) {
  const std::complex<double> back = std::polar(1.0, -w_T);
  return (c.b0 + back * (c.b1 + back * c.b2)) / (1.0 + back * (c.a1 + back * c.a2));
}

std::complex<double> response(const FilterChain& chain, double w_T) {
  std::complex<double> H = 1.0;
  for (std::size_t n = 0; n < chain.count; ++n) H *= response(chain.sections[n], w_T);
  return H;
}

FilterState standing_at(const FilterChain& chain, double value) {
  // Transposed direct form II in steady state with gain 1 at frequency 0: all sections pass the
  // value on, so that one value serves the whole chain.
  FilterState state;
  for (std::size_t n = 0; n < chain.count; ++n) {
    const Biquad& c = chain.sections[n];
    state.z[2 * n + 1] = (c.b2 - c.a2) * value;
    state.z[2 * n] = (c.b1 - c.a1) * value + state.z[2 * n + 1];
  }
  return state;
}

void FilterLanes::set_lane(std::size_t lane, const FilterChain& chain) {
  for (std::size_t n = 0; n < kMaxSections; ++n) {
    const Biquad c = n < chain.count ? chain.sections[n] : Biquad{};
    Section& to = sections[n];
    to.b0[lane] = c.b0;
    to.b1[lane] = c.b1;
    to.b2[lane] = c.b2;
    to.a1[lane] = c.a1;
    to.a2[lane] = c.a2;
  }
  count = std::max(count, chain.count);
}

}  // namespace servomill::controllers

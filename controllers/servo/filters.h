/// Filters of the current command: second-order sections from continuous prototypes.
#pragma once

#include <array>
#include <cassert>
#include <complex>
#include <cstddef>

#include "plant/vocabulary/lanes.h"
#include "plant/vocabulary/numbers.h"

namespace servomill::controllers {

/// One section, transposed direct form II, with two states z1, z2:
///
///   y_k  = b0 u_k + z1_(k-1)
///   z1_k = b1 u_k - a1 y_k + z2_(k-1)          H(z) = (b0 + b1/z + b2/z^2) / (1 + a1/z + a2/z^2)
///   z2_k = b2 u_k - a2 y_k
///
/// The default passes everything on.
struct Biquad {
  double b0 = 1.0, b1 = 0.0, b2 = 0.0, a1 = 0.0, a2 = 0.0;
  bool operator==(const Biquad&) const = default;
};

/// Half the sampling rate (Hz): a filter of a loop with period T (s) belongs below it.
constexpr double nyquist_frequency(double T) { return 0.5 / T; }

/// True if a filter at f (Hz) can be designed for period T (s): 0 < f < 1 / (2T).
constexpr bool can_filter(double f, double T) { return f > 0.0 && f < nyquist_frequency(T); }

/// The designs replace s by the bilinear transform with the frequency scale set so that the
/// discrete filter equals its prototype at f (prewarping). With w0 = 2 pi f:
///
///   H(e^(jwT)) = H_prototype(j w0 tan(wT/2) / tan(w0 T/2))                                     (1)
///
/// All of them have gain 1 at w = 0, and are stable for every f and T with can_filter(f, T) and
/// every damping > 0.
/// @param f  Hz, can_filter(f, T)
/// @param T  s, period at which the filter runs
/// Source: K. J. Astrom, B. Wittenmark, Computer-Controlled Systems, 3rd ed. 1997, section 8.3.

/// (s^2 + 2 zeta_num w0 s + w0^2) / (s^2 + 2 zeta_den w0 s + w0^2): gain zeta_num / zeta_den at f;
/// a deep notch takes away more than 3 dB over a width of about 2 zeta_den f.
/// @param zeta_num  >= 0; 0 blocks f completely
/// @param zeta_den  > 0
Biquad notch(double f, double zeta_num, double zeta_den, double T);

/// w0 / (s + w0).
Biquad low_pass(double f, double T);

/// w0^2 / (s^2 + 2 zeta w0 s + w0^2), zeta > 0.
Biquad low_pass(double f, double zeta, double T);

/// (1 + s/w_zero) / (1 + s/w_pole): lead if f_zero < f_pole, lag if not. Prewarped at the geometric
/// mean of both frequencies, where the phase is largest.
Biquad lead_lag(double f_zero, double f_pole, double T);

/// H(e^(jwT)) of a section.
/// @param w_T  w T, rad per sample
std::complex<double> response(const Biquad& section, double w_T);

inline constexpr std::size_t kMaxSections = 4;

/// Sections in a row; an empty chain passes everything on, bit for bit.
struct FilterChain {
  std::array<Biquad, kMaxSections> sections = {};
  std::size_t count = 0;

  void append(const Biquad& section) {  ///< @pre count < kMaxSections
    assert(count < kMaxSections);
    sections[count++] = section;
  }
};

/// z1, z2 of each section.
struct FilterState {
  std::array<double, 2 * kMaxSections> z{};
};

std::complex<double> response(const FilterChain& chain, double w_T);

/// State of a chain whose input has been `value` for long.
FilterState standing_at(const FilterChain& chain, double value);

/// Filter chains of eight axes; axes with fewer sections than others pass the rest.
struct FilterLanes {
  struct Section {
    LaneArray b0, b1, b2, a1, a2;
  };
  std::array<Section, kMaxSections> sections = {};
  std::size_t count = 0;

  void set_lane(std::size_t lane, const FilterChain& chain);
};
struct FilterLanesState {
  std::array<LaneArray, 2 * kMaxSections> z{};
};

/// Next sample in, next sample out: a FilterChain of doubles, or FilterLanes.
template <class Chain, class State, class Number>
Number advance(const Chain& chain, State& state, Number u) {
  for (std::size_t n = 0; n < chain.count; ++n) {
    const auto& c = chain.sections[n];
    auto& z1 = state.z[2 * n];
    auto& z2 = state.z[2 * n + 1];
    const Number y = value<Number>(c.b0) * u + value<Number>(z1);
    put(z1, value<Number>(c.b1) * u - value<Number>(c.a1) * y + value<Number>(z2));
    put(z2, value<Number>(c.b2) * u - value<Number>(c.a2) * y);
    u = y;
  }
  return u;
}

}  // namespace servomill::controllers

/// The errors of the axes at given coordinates, and how they move the tool: what the volumetric
/// kernels share. Only kernels include this.
///
/// A fault, the errors of one axis, moves the tool by p <- R (p - c) + c + w, k <- R k.
#pragma once

#include "plant/geometry/volumetric_kernel.h"
#include "plant/geometry/volumetric_registers.h"

namespace servomill::plant {
namespace {  // one copy for each instruction set

// --- the turn of a vector of angles -------------------------------------------------------------

// Rot(e) v = v + a e x (v + h e x v), with h = tan(t/2)/t, a = sin t/t for t = |e|.
template <class N>
struct TurnFactors {
  N a, h;
};

template <class N>
SERVOMILL_INLINE TurnFactors<N> small_turn_factors(const N& t2) {
  return {fma(t2, fma(t2, all<N>(1.0 / 120.0), all<N>(-1.0 / 6.0)), all<N>(1.0)),
          fma(t2, fma(t2, all<N>(1.0 / 240.0), all<N>(1.0 / 24.0)), all<N>(0.5))};
}

// a is computed from h: what belongs together turns by some angle, even where h is large.
[[gnu::noinline]] inline TurnFactors<double> turn_factors(double t2) {
  if (t2 < kSeriesTurn * kSeriesTurn) return small_turn_factors(t2);
  const double t = std::sqrt(t2), quarter = sine(0.25 * t);
  const double cosine = fnma(2.0 * quarter, quarter, 1.0);
  const double tangent = sine(0.5 * t) / (cosine == 0.0 ? 0x1p-54 : cosine);
  const double h = tangent / t;
  return {2.0 * h / fma(tangent, tangent, 1.0), h};
}
template <class Factors>
SERVOMILL_INLINE TurnFactors<Register> lane_by_lane(const Register& t2, Factors factors_of) {
  TurnFactors<Register> f;
  for (std::size_t n = 0; n < kRegister; ++n) {
    const TurnFactors<double> of_lane = factors_of(t2[n]);
    f.a[n] = of_lane.a;
    f.h[n] = of_lane.h;
  }
  return f;
}
[[gnu::noinline]] inline TurnFactors<Register> turn_factors(const Register& t2) {
  return lane_by_lane(t2, [](double lane) { return turn_factors(lane); });
}

// v + (R - 1) p
template <class N, class F>
SERVOMILL_INLINE Vector<N> turned_by(const F& f, const Vector<N>& p, const Vector<N>& v) {
  const Vector<N> a{f.a(0), f.a(1), f.a(2)}, h{f.h(0), f.h(1), f.h(2)};
  return plus_cross(v, a, plus_cross(p, h, p));
}

// Ways through the same formulas, each for more cases than the one before. One that finds a turn
// too large for it is given up, to be gone again in general.
enum class Way {
  cubic,   // cubic polynomials and small turns: calls nothing
  small,   // any functions, small turns
  general  // any functions, any turns
};

SERVOMILL_INLINE bool are_small_turns(const Register& t2_max) {
  return !xsimd::any(Batch(t2_max) >= Batch(kSeriesTurn * kSeriesTurn));
}

// --- the errors of an axis ----------------------------------------------------------------------

// w, and the turn as a e and h e.
struct Fault {
  Register w_[3], a_[3], h_[3];

  SERVOMILL_INLINE const Register& w(std::size_t i) const { return w_[i]; }
  SERVOMILL_INLINE const Register& a(std::size_t i) const { return a_[i]; }
  SERVOMILL_INLINE const Register& h(std::size_t i) const { return h_[i]; }
};

// Several components at once, by Horner's rule; coefficient(power, component), terms(component).
template <Way way, std::size_t kComponents, class F, class G>
SERVOMILL_INLINE void evaluate(const VolumetricFunctions& functions, const Register& q,
                               F coefficient, G terms, Register (&e)[kErrorComponents]) {
  const auto next = [&](std::size_t power) SERVOMILL_INLINE_LAMBDA {
    repeat<kComponents>(
        [&](auto c) SERVOMILL_INLINE_LAMBDA { e[c] = fma(e[c], q, coefficient(power, c)); });
  };
  const std::size_t degree = way == Way::cubic ? 3 : functions.degree;
  repeat<kComponents>([&](auto c) SERVOMILL_INLINE_LAMBDA { e[c] = coefficient(degree, c); });
  if constexpr (way == Way::cubic) {
    repeat<3>([&](auto done) SERVOMILL_INLINE_LAMBDA { next(2 - done); });
  } else {
    for (std::size_t i = degree; i-- > 0;) next(i);
    if (functions.has_terms) {
      repeat<kComponents>([&](auto c) SERVOMILL_INLINE_LAMBDA { e[c] = e[c] + terms(c); });
    }
  }
}

template <Way way>
SERVOMILL_INLINE void set_turn(const Register (&e)[kErrorComponents], Fault& fault,
                               Register& t2_max) {
  const Register t2 = fma(e[5], e[5], fma(e[4], e[4], e[3] * e[3]));
  const auto [a, h] = way == Way::general ? turn_factors(t2) : small_turn_factors(t2);
  t2_max = xsimd::max(Batch(t2_max), Batch(t2));
  for (std::size_t i = 0; i < 3; ++i) {
    fault.a_[i] = a * e[3 + i];
    fault.h_[i] = h * e[3 + i];
  }
}

template <Way way, class F, class G>
SERVOMILL_INLINE void find_fault(const VolumetricFunctions& functions, bool has_angles,
                                 const Register& q, F coefficient, G terms, Fault& fault,
                                 Register& t2_max) {
  Register e[kErrorComponents];
  if (has_angles) {
    evaluate<way, 6>(functions, q, coefficient, terms, e);
    set_turn<way>(e, fault, t2_max);
  } else {
    evaluate<way, 3>(functions, q, coefficient, terms, e);
  }
  for (std::size_t i = 0; i < 3; ++i) fault.w_[i] = e[i];
}

// --- one pose: axes in lanes --------------------------------------------------------------------

// Harmonics and tables at q. What is summed is read and written in whole registers only: a register
// that was written number by number is slow to be read.
inline void find_terms(const VolumetricFunctions& functions, const VolumetricPower* tables,
                       const double* q, VolumetricPower& sums) {
  if (tables != nullptr) {
    sums = *tables;
  } else {
    sums = {};
  }
  const VolumetricHarmonic* h = functions.harmonics;
  for (std::size_t first = 0; first < functions.number_of_waves; first += kRegister) {
    const VolumetricWaves& waves = functions.waves[first / kLaneWidth];
    const std::size_t lane = first % kLaneWidth;
    const Register at = lanes_from([&](std::size_t n) { return q[waves.axis[lane + n]]; });
    double sines[kRegister];
    store(sine<Register>(load(waves.omega, lane) * at + load(waves.phase, lane)), sines);
    for (; h->wave < first + kRegister; ++h) {
      const Register value = all<Register>(sines[h->wave - first]);
      for (std::size_t n = 0; n < functions.axes; n += kRegister) {
        LaneArray& sum = sums.e[h->component];
        store(fma(load(h->amplitude, n), value, load(sum, n)), sum, n);
      }
    }
  }
}

// Calls use(first, q, fault) for each register of axes, which begins with axis `first`. q: of the
// first kAxes axes. False where a turn is too large for this way.
template <Way way, std::size_t kAxes, class Use>
SERVOMILL_INLINE bool find_faults(const VolumetricFunctions& functions, bool has_angles,
                                  const VolumetricPower* tables, const double* q, Use use) {
  VolumetricPower sums;
  if constexpr (way != Way::cubic) {
    if (functions.has_terms) find_terms(functions, tables, q, sums);
  }
  Register t2_max{};
  repeat<(kAxes + kRegister - 1) / kRegister>([&](auto block) SERVOMILL_INLINE_LAMBDA {
    constexpr std::size_t first = block() * kRegister;
    if (first >= functions.axes) return;
    const auto coefficient = [&](std::size_t power, std::size_t component) SERVOMILL_INLINE_LAMBDA {
      return load(functions.polynomial[power].e[component], first);
    };
    const auto terms = [&](std::size_t component)
                           SERVOMILL_INLINE_LAMBDA { return load(sums.e[component], first); };
    const Register at = lanes_from([&](std::size_t n) SERVOMILL_INLINE_LAMBDA {
      return first + n < kAxes ? q[first + n] : 0.0;
    });
    Fault fault;
    find_fault<way>(functions, has_angles, at, coefficient, terms, fault, t2_max);
    use(block, at, fault);
  });
  return way == Way::general || !has_angles || are_small_turns(t2_max);
}

// --- many poses: poses in lanes -----------------------------------------------------------------

// Harmonics and tables at q[axis], the lanes from `first` on of eight.
template <std::size_t kAxes>
inline void find_terms(const VolumetricFunctions& functions, const VolumetricPower* tables,
                       std::size_t first, const Register (&q)[kAxes],
                       Register (&sums)[kAxes][kErrorComponents]) {
  for (std::size_t axis = 0; axis < functions.axes; ++axis) {
    for (std::size_t c = 0; c < kErrorComponents; ++c) {
      sums[axis][c] = tables != nullptr ? load(tables[axis].e[c], first) : Register{};
    }
  }
  const VolumetricHarmonic* h = functions.harmonics;
  for (std::size_t wave = 0; wave < functions.number_of_waves; ++wave) {
    const VolumetricWaves& waves = functions.waves[wave / kLaneWidth];
    const std::size_t lane = wave % kLaneWidth, axis = waves.axis[lane];
    const Register value = sine<Register>(waves.omega[lane] * q[axis] + waves.phase[lane]);
    for (; h->wave == wave; ++h) {
      Register& sum = sums[axis][h->component];
      sum = fma(all<Register>(h->amplitude[axis]), value, sum);
    }
  }
}

}  // namespace
}  // namespace servomill::plant

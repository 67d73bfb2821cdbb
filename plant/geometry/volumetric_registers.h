/// Numbers of the volumetric kernels: doubles, registers of as many as the instruction set holds,
/// and vectors of either. Only kernels include this (plant/vocabulary/pack.h says why everything in
/// it stays within each object).
///
/// Formulas are templates over the number N. They round alike for a double and in each lane of a
/// register, so that one pose has the same bits alone and among others.
#pragma once

#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>
#include <xsimd/xsimd.hpp>

#include "plant/vocabulary/lanes.h"
#include "plant/vocabulary/sine_and_cosine.h"

#define SERVOMILL_INLINE [[gnu::always_inline]] inline
#define SERVOMILL_INLINE_LAMBDA __attribute__((always_inline))

namespace servomill::plant {
namespace {  // one copy for each instruction set

using Batch = xsimd::batch<double, SERVOMILL_ARCH>;
constexpr std::size_t kRegister = Batch::size;

// A register as the compiler knows it: with the operators of numbers, also beside numbers.
using Register [[gnu::vector_size(kRegister * sizeof(double))]] = double;

SERVOMILL_INLINE Register load(const double* from) { return Batch::load_unaligned(from); }
SERVOMILL_INLINE Register load(const LaneArray& from, std::size_t first) {
  return Batch::load_aligned(&from[0] + first);
}
SERVOMILL_INLINE void store(const Register& value, double* to) { Batch(value).store_unaligned(to); }
SERVOMILL_INLINE void store(const Register& value, LaneArray& to, std::size_t first) {
  Batch(value).store_aligned(&to[0] + first);
}

// Two registers as one number. A formula of them does two things at a time that do not wait for
// each other: the processor looks too few instructions ahead to find such by itself.
struct Pair {
  Register first, second;
};
SERVOMILL_INLINE Pair operator+(const Pair& a, const Pair& b) {
  return {a.first + b.first, a.second + b.second};
}
SERVOMILL_INLINE Pair operator+(const Pair& a, double b) { return {a.first + b, a.second + b}; }
SERVOMILL_INLINE Pair operator*(const Pair& a, const Pair& b) {
  return {a.first * b.first, a.second * b.second};
}
SERVOMILL_INLINE void store(const Pair& value, double* to) {
  store(value.first, to);
  store(value.second, to + kRegister);
}
template <class N>
SERVOMILL_INLINE N load_number(const double* from) {
  if constexpr (std::is_same_v<N, Pair>) {
    return {load(from), load(from + kRegister)};
  } else {
    return load(from);
  }
}

// One value for all lanes.
template <class N>
SERVOMILL_INLINE N all(double value) {
  if constexpr (std::is_same_v<N, Pair>) {
    return {value - Register{}, value - Register{}};
  } else {
    return value - N{};
  }
}

template <class F, std::size_t... i>
SERVOMILL_INLINE void for_each(std::index_sequence<i...>, F f) {
  (f(std::integral_constant<std::size_t, i>()), ...);
}
template <std::size_t count, class F>
SERVOMILL_INLINE void repeat(F f) {
  for_each(std::make_index_sequence<count>(), f);
}

template <class F, std::size_t... lane>
SERVOMILL_INLINE Register lanes_from(F value, std::index_sequence<lane...>) {
  return Register{value(lane)...};
}
template <class F>
SERVOMILL_INLINE Register lanes_from(F value) {
  return lanes_from(value, std::make_index_sequence<kRegister>());
}

// a b + c, c - a b and a b - c, rounded once where the machine can: numbers and registers alike.
#ifdef FP_FAST_FMA
SERVOMILL_INLINE double fma(double a, double b, double c) { return __builtin_fma(a, b, c); }
#else
SERVOMILL_INLINE double fma(double a, double b, double c) { return a * b + c; }
#endif
SERVOMILL_INLINE Register fma(const Register& a, const Register& b, const Register& c) {
#ifdef __AVX512F__  // xsimd 8 rounds twice here
  return _mm512_fmadd_pd(a, b, c);
#else
  return xsimd::fma(Batch(a), Batch(b), Batch(c));
#endif
}
// The compiler does not see that -a b + c is one instruction, too.
SERVOMILL_INLINE double fnma(double a, double b, double c) { return fma(-a, b, c); }
SERVOMILL_INLINE Register fnma(const Register& a, const Register& b, const Register& c) {
#if defined(__AVX512F__)
  return _mm512_fnmadd_pd(a, b, c);
#else
  return xsimd::fnma(Batch(a), Batch(b), Batch(c));
#endif
}
SERVOMILL_INLINE double fms(double a, double b, double c) { return fma(a, b, -c); }
SERVOMILL_INLINE Register fms(const Register& a, const Register& b, const Register& c) {
#if defined(__AVX512F__)
  return _mm512_fmsub_pd(a, b, c);
#else
  return xsimd::fms(Batch(a), Batch(b), Batch(c));
#endif
}
SERVOMILL_INLINE Pair fma(const Pair& a, const Pair& b, const Pair& c) {
  return {fma(a.first, b.first, c.first), fma(a.second, b.second, c.second)};
}
SERVOMILL_INLINE Pair fnma(const Pair& a, const Pair& b, const Pair& c) {
  return {fnma(a.first, b.first, c.first), fnma(a.second, b.second, c.second)};
}
SERVOMILL_INLINE Pair fms(const Pair& a, const Pair& b, const Pair& c) {
  return {fms(a.first, b.first, c.first), fms(a.second, b.second, c.second)};
}

// The sine, with an error below one unit in the last place of 1: Taylor's series of x less the
// nearest multiple n of pi, which is subtracted in three parts. The products of the first two are
// exact for n < 2^20; beyond, their rounding is no larger than that of x itself. n is what the
// rounding of an addition leaves in the last bits; the last one changes the sign.
template <class N>
SERVOMILL_INLINE N sine(const N& x) {
  using Whole = typename WholeNumbers<N>::Type;
  const N shifted = x * 0x1.45f306dc9c883p-2 + 0x1.8p52;
  const N n = shifted - 0x1.8p52;
  const Whole sign = __builtin_bit_cast(Whole, shifted) << 63;
  const N rest = fnma(n, all<N>(0x1.3198a2e037073p-68),
                      fnma(n, all<N>(0x1.0b4611a6p-33), fnma(n, all<N>(0x1.921fb544p1), x)));
  const N r = __builtin_bit_cast(N, __builtin_bit_cast(Whole, rest) ^ sign);
  const N z = r * r, zz = z * z;
  const auto series = [&zz](double c0, double c1, double c2, double c3, double c4) {
    N sum = fma(zz, all<N>(c4), all<N>(c3));
    sum = fma(zz, sum, all<N>(c2));
    sum = fma(zz, sum, all<N>(c1));
    return fma(zz, sum, all<N>(c0));
  };
  const N a = series(-1.0 / 6.0, -1.0 / 5040.0, -1.0 / 39916800.0, -1.0 / 1307674368000.0,
                     -1.0 / 121645100408832000.0);
  const N b = series(1.0 / 120.0, 1.0 / 362880.0, 1.0 / 6227020800.0, 1.0 / 355687428096000.0,
                     1.0 / 51090942171709440000.0);
  const N rz = r * z;
  return fma(rz, fma(z, b, a), r);
}

// --- vectors -----------------------------------------------------------------------------------

template <class N>
struct Vector {
  N v[3];
};

template <class N>
SERVOMILL_INLINE Vector<N> turned(int k, const N& cosine, const N& sine, const Vector<N>& p) {
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  Vector<N> u = p;
  u.v[i] = cosine * p.v[i] - sine * p.v[j];
  u.v[j] = sine * p.v[i] + cosine * p.v[j];
  return u;
}
template <class N>
SERVOMILL_INLINE Vector<N> plus(const Vector<N>& p, const double* d) {
  return {p.v[0] + d[0], p.v[1] + d[1], p.v[2] + d[2]};
}
template <class N>
SERVOMILL_INLINE Vector<N> minus(const Vector<N>& p, const double* d) {
  return {p.v[0] - d[0], p.v[1] - d[1], p.v[2] - d[2]};
}
template <class N>
SERVOMILL_INLINE Vector<N> minus(const Vector<N>& p, const Vector<N>& q) {
  return {p.v[0] - q.v[0], p.v[1] - q.v[1], p.v[2] - q.v[2]};
}
template <class N>
SERVOMILL_INLINE Vector<N> times(const double (&R)[3][3], const Vector<N>& p) {
  Vector<N> u;
  for (int i = 0; i < 3; ++i) {
    u.v[i] = (R[i][0] * p.v[0] + R[i][1] * p.v[1]) + R[i][2] * p.v[2];
  }
  return u;
}
template <class N>
SERVOMILL_INLINE Vector<N> transpose_times(const double (&R)[3][3], const Vector<N>& p) {
  Vector<N> u;
  for (int i = 0; i < 3; ++i) {
    u.v[i] = (R[0][i] * p.v[0] + R[1][i] * p.v[1]) + R[2][i] * p.v[2];
  }
  return u;
}
// v + e x u, in an order of additions that is the same wherever it is computed
template <class N>
SERVOMILL_INLINE Vector<N> plus_cross(const Vector<N>& v, const Vector<N>& e, const Vector<N>& u) {
  return {fma(e.v[1], u.v[2], fnma(e.v[2], u.v[1], v.v[0])),
          fma(e.v[2], u.v[0], fnma(e.v[0], u.v[2], v.v[1])),
          fma(e.v[0], u.v[1], fnma(e.v[1], u.v[0], v.v[2]))};
}

// e x u
template <class N>
SERVOMILL_INLINE Vector<N> cross(const Vector<N>& e, const Vector<N>& u) {
  return {fnma(e.v[2], u.v[1], e.v[1] * u.v[2]), fnma(e.v[0], u.v[2], e.v[2] * u.v[0]),
          fnma(e.v[1], u.v[0], e.v[0] * u.v[1])};
}

}  // namespace
}  // namespace servomill::plant

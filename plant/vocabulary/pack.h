/// Arithmetic of eight lanes on one instruction set. Only kernels include this: sources that CMake
/// compiles once for each instruction set (servomill_kernel), with SERVOMILL_ARCH as its name for
/// xsimd and SERVOMILL_LEVEL as ours:
///
///   template <>
///   DriveKernel make_drive_kernel<SERVOMILL_LEVEL>() { return {&advance<SERVOMILL_ARCH>}; }
///
/// A kernel must not leave inline functions behind that other sources share: compiled for a newer
/// processor, the linker might give them to all. So no Eigen, no containers here; templates over
/// the architecture, and what is in an anonymous namespace. tests/laws/simd_objects.py looks.
#pragma once

#include <cmath>
#include <cstddef>
#include <xsimd/xsimd.hpp>

#include "plant/vocabulary/lanes.h"
#include "plant/vocabulary/numbers.h"
#include "plant/vocabulary/simd.h"

namespace servomill {

/// a b + c. xsimd 8.1 does not know that of AVX-512 and would round twice.
template <class Arch>
xsimd::batch<double, Arch> fused(const xsimd::batch<double, Arch>& a,
                                 const xsimd::batch<double, Arch>& b,
                                 const xsimd::batch<double, Arch>& c) {
#ifdef __AVX512F__
  if constexpr (xsimd::batch<double, Arch>::size == kLaneWidth) return _mm512_fmadd_pd(a, b, c);
#endif
  return xsimd::fma(a, b, c);
}

/// Eight truths.
template <class Arch>
struct PackMask {
  using Batch = xsimd::batch_bool<double, Arch>;
  static constexpr std::size_t kRegisters = kLaneWidth / xsimd::batch<double, Arch>::size;
  Batch r[kRegisters];

  friend PackMask operator&(const PackMask& a, const PackMask& b) {
    PackMask c;
#pragma GCC unroll 4
    for (std::size_t n = 0; n < kRegisters; ++n) c.r[n] = a.r[n] & b.r[n];
    return c;
  }
  friend PackMask operator|(const PackMask& a, const PackMask& b) {
    PackMask c;
#pragma GCC unroll 4
    for (std::size_t n = 0; n < kRegisters; ++n) c.r[n] = a.r[n] | b.r[n];
    return c;
  }
  friend PackMask operator!(const PackMask& a) {
    PackMask c;
#pragma GCC unroll 4
    for (std::size_t n = 0; n < kRegisters; ++n) c.r[n] = !a.r[n];
    return c;
  }
  bool any() const {
    bool result = false;
#pragma GCC unroll 4
    for (std::size_t n = 0; n < kRegisters; ++n) result |= xsimd::any(r[n]);
    return result;
  }
  bool all() const { return !(!*this).any(); }

  /// One bit for each lane, lane 0 the lowest.
  unsigned bits() const {
    unsigned result = 0;
#pragma GCC unroll 4
    for (std::size_t n = 0; n < kRegisters; ++n) result |= bits_of(r[n]) << (n * Batch::size);
    return result;
  }
  static PackMask of(unsigned bits) {
    PackMask c;
#pragma GCC unroll 4
    for (std::size_t n = 0; n < kRegisters; ++n) set(c.r[n], bits >> (n * Batch::size));
    return c;
  }

 private:
  static unsigned bits_of(const Batch& mask) {
#ifdef __AVX512F__
    if constexpr (Batch::size == 8) return mask.data;
#endif
#ifdef __AVX2__
    if constexpr (Batch::size == 4) return static_cast<unsigned>(_mm256_movemask_pd(mask.data));
#endif
    bool truths[Batch::size];
    mask.store_unaligned(truths);
    unsigned result = 0;
    for (std::size_t j = 0; j < Batch::size; ++j) result |= (truths[j] ? 1U : 0U) << j;
    return result;
  }
  static void set(Batch& mask, unsigned bits) {
#ifdef __AVX512F__
    if constexpr (Batch::size == 8) {
      mask.data = static_cast<__mmask8>(bits);
      return;
    }
#endif
    bool truths[Batch::size];
    for (std::size_t j = 0; j < Batch::size; ++j) truths[j] = bits >> j & 1U;
    mask = Batch::load_unaligned(truths);
  }
};

/// Eight doubles.
template <class Arch>
struct Pack {
  using Batch = xsimd::batch<double, Arch>;
  using Mask = PackMask<Arch>;
  static constexpr std::size_t kRegisters = kLaneWidth / Batch::size;
  Batch r[kRegisters];

  Pack() = default;
  Pack(double value) {  // NOLINT: a number stands for eight of it in formulas
#pragma GCC unroll 4
    for (std::size_t n = 0; n < kRegisters; ++n) r[n] = Batch(value);
  }
  explicit Pack(const LaneArray& from) {
#pragma GCC unroll 4
    for (std::size_t n = 0; n < kRegisters; ++n) {
      r[n] = Batch::load_aligned(&from[0] + n * Batch::size);
    }
  }
  void store(LaneArray& to) const {
#pragma GCC unroll 4
    for (std::size_t n = 0; n < kRegisters; ++n) r[n].store_aligned(&to[0] + n * Batch::size);
  }

  friend void put(LaneArray& to, const Pack& number) { number.store(to); }

  template <class F>
  static Pack each(F f) {
    Pack c;
#pragma GCC unroll 4
    for (std::size_t n = 0; n < kRegisters; ++n) c.r[n] = f(n);
    return c;
  }
  template <class F>
  static Mask test(F f) {
    Mask c;
#pragma GCC unroll 4
    for (std::size_t n = 0; n < kRegisters; ++n) c.r[n] = f(n);
    return c;
  }

  friend Pack operator+(const Pack& a, const Pack& b) {
    return each([&](std::size_t n) { return a.r[n] + b.r[n]; });
  }
  friend Pack operator-(const Pack& a, const Pack& b) {
    return each([&](std::size_t n) { return a.r[n] - b.r[n]; });
  }
  friend Pack operator*(const Pack& a, const Pack& b) {
    return each([&](std::size_t n) { return a.r[n] * b.r[n]; });
  }
  friend Pack operator/(const Pack& a, const Pack& b) {
    return each([&](std::size_t n) { return a.r[n] / b.r[n]; });
  }
  friend Pack operator-(const Pack& a) {
    return each([&](std::size_t n) { return -a.r[n]; });
  }
  Pack& operator+=(const Pack& b) { return *this = *this + b; }
  Pack& operator-=(const Pack& b) { return *this = *this - b; }

  friend Mask operator<(const Pack& a, const Pack& b) {
    return test([&](std::size_t n) { return a.r[n] < b.r[n]; });
  }
  friend Mask operator<=(const Pack& a, const Pack& b) {
    return test([&](std::size_t n) { return a.r[n] <= b.r[n]; });
  }
  friend Mask operator>(const Pack& a, const Pack& b) { return b < a; }
  friend Mask operator>=(const Pack& a, const Pack& b) { return b <= a; }
  friend Mask operator==(const Pack& a, const Pack& b) {
    return test([&](std::size_t n) { return a.r[n] == b.r[n]; });
  }
  friend Mask operator!=(const Pack& a, const Pack& b) {
    return test([&](std::size_t n) { return a.r[n] != b.r[n]; });
  }

  /// a b + c, rounded once where the machine can.
  friend Pack fma(const Pack& a, const Pack& b, const Pack& c) {
    return each([&](std::size_t n) { return fused<Arch>(a.r[n], b.r[n], c.r[n]); });
  }
  friend Pack select(const Mask& mask, const Pack& yes, const Pack& no) {
    return each([&](std::size_t n) { return xsimd::select(mask.r[n], yes.r[n], no.r[n]); });
  }
  friend Pack min(const Pack& a, const Pack& b) {
    return each([&](std::size_t n) { return xsimd::min(a.r[n], b.r[n]); });
  }
  friend Pack max(const Pack& a, const Pack& b) {
    return each([&](std::size_t n) { return xsimd::max(a.r[n], b.r[n]); });
  }
  friend Pack abs(const Pack& a) {
    return each([&](std::size_t n) { return xsimd::abs(a.r[n]); });
  }
  friend Pack sqrt(const Pack& a) {
    return each([&](std::size_t n) { return xsimd::sqrt(a.r[n]); });
  }
  /// The next whole number, ties to even.
  friend Pack nearbyint(const Pack& a) {
    return each([&](std::size_t n) { return xsimd::nearbyint(a.r[n]); });
  }
};

}  // namespace servomill

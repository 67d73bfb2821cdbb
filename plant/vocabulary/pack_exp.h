/// The exponential function of eight lanes. Only kernels include this (plant/vocabulary/pack.h).
#pragma once

#include <cstddef>
#include <cstdint>

#include "plant/vocabulary/pack.h"

namespace servomill {
namespace {  // one copy for each instruction set

/// e^x for x <= 0, to the last bit or two, by Taylor's series about the nearest multiple of ln 2.
/// Below -200 it is e^-200: products with it must not become subnormal, which is slow.
template <class Arch>
Pack<Arch> exp_of_negative(const Pack<Arch>& x) {
  using P = Pack<Arch>;
  using Bits = xsimd::batch<std::int64_t, Arch>;
  constexpr double kMin = -200.0;
  constexpr double kRound = 6755399441055744.0;  // 3 2^51: its last bit counts ones
  constexpr double kLog2e = 1.4426950408889634, kLn2 = 0x1.62e42fefa0000p-1;
  constexpr double kLn2Rest = 0x1.cf79abc9e3b39p-40;
  const P y = max(x, P(kMin));
  const P rounded = fma(y, P(kLog2e), P(kRound)), n = rounded - P(kRound);
  const P r = fma(n, P(-kLn2Rest), fma(n, P(-kLn2), y));
  const auto pair = [&](double a, double b) { return fma(P(b), r, P(a)); };
  const P r2 = r * r, r4 = r2 * r2;
  const P a = fma(pair(0.5, 1.0 / 6), r2, r + P(1.0));
  const P b = fma(pair(1.0 / 720, 1.0 / 5040), r2, pair(1.0 / 24, 1.0 / 120));
  const P c = fma(pair(1.0 / 3628800, 1.0 / 39916800), r2, pair(1.0 / 40320, 1.0 / 362880));
  const P d(1.0 / 479001600);
  const P mantissa = fma(fma(fma(d, r4, c), r4, b), r4, a);
  return P::each([&](std::size_t j) {
    const Bits power = (xsimd::bitwise_cast<Bits>(rounded.r[j]) << 52) + Bits(0x3ff0000000000000);
    return mantissa.r[j] * xsimd::bitwise_cast<typename P::Batch>(power);
  });
}

}  // namespace
}  // namespace servomill

/// One sine and cosine for kinematics and for kernels: with the same bits for a double and in each
/// lane of a register, on all instruction sets, since nothing in it is fused.
///
/// As kernels demand (plant/vocabulary/pack.h), everything stays within each object.
#pragma once

namespace servomill {
namespace {  // one copy for each instruction set

/// As many whole numbers as N holds numbers.
template <class N>
struct WholeNumbers {
  using Type [[gnu::vector_size(sizeof(N))]] = long long;
};
template <>
struct WholeNumbers<double> {
  using Type = long long;
};

template <class N>
struct SineAndCosine {
  N sine, cosine;
};

/// Limit above which multiples of pi/2 would no longer be exact.
constexpr double kLargestAngle = 1e6;  // rad

/// Both with an error below one unit in the last place of 1, and exact at 0: Taylor's series of x
/// less the nearest multiple n of pi/2, which is subtracted in three parts. The products of the
/// first two are exact, so that what is left near a multiple has all its bits. n is what the
/// rounding of an addition leaves in the last bits, of which two name the quadrant.
/// @param x  rad, |x| < kLargestAngle
template <class N>
[[gnu::always_inline]] inline SineAndCosine<N> sine_and_cosine(const N& x) {
  using Whole = typename WholeNumbers<N>::Type;
  const N shifted = x * 0x1.45f306dc9c883p-1 + 0x1.8p52;
  const N n = shifted - 0x1.8p52;
  const N r = ((x - n * 0x1.921fb544p0) - n * 0x1.0b4611a6p-34) - n * 0x1.3198a2e037073p-69;
  const N z = r * r, z2 = z * z, z4 = z2 * z2;
  const N s = ((-1.0 / 6.0 + 1.0 / 120.0 * z) + (-1.0 / 5040.0 + 1.0 / 362880.0 * z) * z2) +
              ((-1.0 / 39916800.0 + 1.0 / 6227020800.0 * z) +
               (-1.0 / 1307674368000.0 + 1.0 / 355687428096000.0 * z) * z2) *
                  z4;
  const N c = ((1.0 / 24.0 - 1.0 / 720.0 * z) + (1.0 / 40320.0 - 1.0 / 3628800.0 * z) * z2) +
              ((1.0 / 479001600.0 - 1.0 / 87178291200.0 * z) +
               (1.0 / 20922789888000.0 - 1.0 / 6402373705728000.0 * z) * z2) *
                  z4;
  const N half = 0.5 * z, most = 1.0 - half;
  const N sine = r + (r * z) * s, cosine = most + (((1.0 - most) - half) + z2 * c);

  const Whole quadrant = __builtin_bit_cast(Whole, shifted), is_odd = -(quadrant & 1);
  const Whole a = __builtin_bit_cast(Whole, sine), b = __builtin_bit_cast(Whole, cosine);
  const Whole swapped = (a ^ b) & is_odd;
  const Whole minus_sine = (quadrant & 2) << 62, minus_cosine = ((quadrant + 1) & 2) << 62;
  return {__builtin_bit_cast(N, (a ^ swapped) ^ minus_sine),
          __builtin_bit_cast(N, (b ^ swapped) ^ minus_cosine)};
}

/// The same for any x, by the C library where it is large.
[[gnu::noinline]] inline SineAndCosine<double> large_sine_and_cosine(double x) {
  return {__builtin_sin(x), __builtin_cos(x)};
}
[[gnu::always_inline]] inline bool is_large(double x) {
  return !(__builtin_fabs(x) < kLargestAngle);  // true of what is not a number
}

}  // namespace
}  // namespace servomill

/// Eight drives in registers: friction, motion and the products with their coefficients. Only the
/// kernel of the drives includes this (plant/vocabulary/pack.h); nothing here is linked.
#pragma once

#include <cstddef>

#include "plant/drives/collocation.h"
#include "plant/drives/drive_kernel.h"
#include "plant/vocabulary/pack.h"
#include "plant/vocabulary/pack_exp.h"

namespace servomill::plant {
namespace {  // one copy for each instruction set

// Friction of eight drives, with the members of FrictionParams. Lanes that are not active have any
// values.
template <class Arch>
struct FrictionPack {
  using P = Pack<Arch>;
  using Mask = PackMask<Arch>;
  P Fc_positive, Fc_negative, Fs_positive, Fs_negative, b_positive, b_negative, sigma0, sigma1,
      inverse_vs, inverse_v0;
  Mask idle;

  FrictionPack(const DriveConstants& c, LaneBits active)
      : Fc_positive(c.Fc_positive),
        Fc_negative(c.Fc_negative),
        Fs_positive(c.Fs_positive),
        Fs_negative(c.Fs_negative),
        b_positive(c.b_positive),
        b_negative(c.b_negative),
        sigma0(c.sigma0),
        sigma1(c.sigma1),
        inverse_vs(c.inverse_vs),
        inverse_v0(c.inverse_v0),
        idle(Mask::of(0xFFU & ~active)) {}

  WithSlope<P> stribeck(const P& v) const {
    const P q = v * inverse_vs, bump = exp_of_negative(-(q * q));
    return {bump, P(-2.0) * q * inverse_vs * bump};
  }
  // Beyond its end the formula gives 1 and 0 to the bit, so that it need not be computed there.
  WithSlope<P> saturation(const P& v) const {
    const P q = v * inverse_v0, one(1.0), zero(0.0);
    if (((abs(q) > P(kTanhEnd)) | idle).all()) return {select(q > zero, one, -one), zero};
    const P e = exp_of_negative(P(-2.0) * abs(q)), T = (one - e) / (one + e);
    return {select(q > zero, T, -T), (one - T * T) * inverse_v0};
  }
};

// Eight drives in motion.
template <class Arch>
struct Motion {
  using P = Pack<Arch>;
  P i, w, delta, v, x, z;
};

// Friction where the last sub-step ended, which is where the next one begins unless the slide has
// moved otherwise since: at the speed `v` the force and its slope; of LuGre, dz/dt and nothing.
template <class Arch>
struct KnownFriction {
  using P = Pack<Arch>;
  P v, value, slope;

  explicit KnownFriction(const DriveBlock& s)
      : v(s.known_v), value(s.known_friction), slope(s.known_slope) {}
  KnownFriction(const P& at, const P& is, const P& rises) : v(at), value(is), slope(rises) {}
  void store(DriveBlock& s) const {
    v.store(s.known_v);
    value.store(s.known_friction);
    slope.store(s.known_slope);
  }
};
template <class Arch>
KnownFriction<Arch> select(const PackMask<Arch>& mask, const KnownFriction<Arch>& yes,
                           const KnownFriction<Arch>& no) {
  return {select(mask, yes.v, no.v), select(mask, yes.value, no.value),
          select(mask, yes.slope, no.slope)};
}

template <class Arch>
Motion<Arch> motion_of(const DriveBlock& s) {
  using P = Pack<Arch>;
  return {P(s.i), P(s.w), P(s.delta), P(s.v), P(s.x), P(s.z)};
}

template <class Arch>
void store(const Motion<Arch>& from, DriveBlock& s) {
  from.i.store(s.i);
  from.w.store(s.w);
  from.delta.store(s.delta);
  from.v.store(s.v);
  from.x.store(s.x);
  from.z.store(s.z);
}

// State of eight drives at the start of a step.
template <class Arch>
struct Start {
  Motion<Arch> at;
  Pack<Arch> command, load;  // load without friction
};

template <class Arch>
Start<Arch> start_of(const DriveBlock& s, const DriveInputBlock& input, const DriveConstants& c) {
  using P = Pack<Arch>;
  return {motion_of<Arch>(s), P(input.command), P(input.F) + P(c.F_load)};
}

template <class Arch, bool same, std::size_t n>
Pack<Arch> coefficient(const Coefficients<n>& from, std::size_t which) {
  if constexpr (same) return Pack<Arch>(from.of_all[which]);
  return Pack<Arch>(from.each[which]);
}

// The sum over `n` columns, in their order, of the row that begins at `first`.
template <class Arch, bool same, std::size_t n, std::size_t size>
Pack<Arch> product(const Coefficients<size>& rows, std::size_t first, const Pack<Arch> (&in)[n]) {
  Pack<Arch> sum = coefficient<Arch, same>(rows, first) * in[0];
#pragma GCC unroll 8
  for (std::size_t column = 1; column < n; ++column) {
    sum = fma(coefficient<Arch, same>(rows, first + column), in[column], sum);
  }
  return sum;
}

}  // namespace
}  // namespace servomill::plant

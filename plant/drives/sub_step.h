/// One sub-step of eight drives in the zone of friction. Only the kernel of the drives includes
/// this (plant/vocabulary/pack.h); nothing here is linked.
#pragma once

#include <cstddef>
#include <limits>

#include "plant/drives/collocation.h"
#include "plant/drives/drive_pack.h"

namespace servomill::plant {
namespace {  // one copy for each instruction set

// One sub-step as ExactStep::attempt makes it, for friction that is a function of v and z.
template <class Arch, FrictionKind kind, bool same>
class SubStep {
  using P = Pack<Arch>;
  using Mask = PackMask<Arch>;

 public:
  Motion<Arch> end;
  P error;       // m; infinite if the collocation was not solved
  P kink = 0.0;  // halvings to before a reversal, 0: there is none

  SubStep(const Motion<Arch>& s, const KnownFriction<Arch>& known, const P& command, const P& load,
          const FrictionPack<Arch>& p, const DriveConstants& c, const ParabolaBlock& block,
          const Mask& active)
      : s_(s), load_(load), p_(p), block_(block), h_(block.h) {
    const P start[5] = {s.i, s.w, s.delta, s.v, command};
    begin(known, active);
#pragma GCC unroll 8
    for (std::size_t row = 0; row < 8; ++row) {
      y_[row] = fma(weight(row, 5), f_[0],
                    product<Arch, same>(block.rows, row * ParabolaBlock::kColumns, start));
    }
    const Mask solved = collocate(active);
#pragma GCC unroll 8
    for (std::size_t row = 0; row < 8; ++row) y_[row] = response(row);
    end = {y_[4], y_[5], y_[6], y_[3], s.x + y_[7], s.z};
    if (c.has_kink != 0) find_kink(Mask::of(c.has_kink));
    estimate_error(c, active);
    error = select(solved, error, P(kInfinity));
    if (kind == FrictionKind::lugre) end.z = z_at(3);
  }

  KnownFriction<Arch> friction_at_end() const { return {end.v, friction_end_, slope_end_}; }
  // Position at a stop.
  P position_at(const Coefficients<ParabolaBlock::kColumns>& row, const P& command) const {
    const P in[] = {s_.i, s_.w, s_.delta, s_.v, command, f_[0], f_[1], f_[2]};
    return s_.x + product<Arch, same>(row, 0, in);
  }
  Mask resolved(const P& tolerance) const { return (error <= tolerance) & (kink == P(0.0)); }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  P weight(std::size_t row, std::size_t column) const {
    return coefficient<Arch, same>(block_.rows, row * ParabolaBlock::kColumns + column);
  }
  P response(std::size_t row) const {
    return fma(weight(row, 7), f_[2], fma(weight(row, 6), f_[1], y_[row]));
  }
  P z_at(int node) const { return fma(h_, parabola(kIntegral[node], dz_), s_.z); }

  // Friction at the start and its slope; of LuGre, dz/dt.
  WithSlope<P> at_start() const {
    if constexpr (kind == FrictionKind::lugre) {
      return {bristle_rate(p_, s_.v, s_.z), P(0.0)};
    } else {
      return regularised(p_, s_.v);
    }
  }

  void begin(const KnownFriction<Arch>& known, const Mask& active) {
    WithSlope<P> at = {known.value, known.slope};
    const Mask is_known = s_.v == known.v;
    if ((active & !is_known).any()) {
      const WithSlope<P> computed = at_start();
      at = {select(is_known, at.value, computed.value), select(is_known, at.slope, computed.slope)};
    }
    slope_ = at.slope;
    if (kind == FrictionKind::lugre) {
      dz_[0] = at.value;
      f_[0] = load_ + fma(p_.sigma0, s_.z, p_.sigma1 * dz_[0]);
    } else {
      f_[0] = load_ + at.value;
    }
  }

  auto friction_at(const P (&v)[2]) const {
    if constexpr (kind == FrictionKind::lugre) {
      return bristles_at(p_, s_.z, dz_[0], h_, v);
    } else {
      return regularised_at(p_, v);
    }
  }

  // Newton's iteration; a lane that has arrived stays as it is. Returns those that did.
  Mask collocate(const Mask& active) {
    constexpr int kMaxIterations = 12;
    constexpr std::size_t kRow[2] = {1, 3};  // of v at h/2 and h
    const Matrix2<P> C = {weight(1, 6), weight(1, 7), weight(3, 6), weight(3, 7)};
    const P tolerance(block_.speed_tolerance);
    P v[2], dv[2];
    f_[1] = f_[2] = f_[0];
    {
      const P way[2] = {response(1) - s_.v, response(3) - s_.v};
      newton(C, Diagonal2<P>{slope_, slope_}, way, dv);
      for (int j = 0; j < 2; ++j) v[j] = s_.v + dv[j];
    }
    Mask open = active;
    for (int n = 0; n < kMaxIterations; ++n) {
      auto at = friction_at(v);
      P f[2] = {load_ + at.f[0], load_ + at.f[1]};
      P residual[2];
      for (int j = 0; j < 2; ++j) {
        const P answer = fma(weight(kRow[j], 7), f[1], fma(weight(kRow[j], 6), f[0], y_[kRow[j]]));
        residual[j] = answer - v[j];
      }
      newton(C, at.df, residual, dv);
      const P change = max(abs(dv[0]), abs(dv[1]));
      if constexpr (kind == FrictionKind::regularised) {
        slope_end_ = select(open, at.df.d, slope_end_);
        friction_end_ = select(open, fma(at.df.d, dv[1], at.f[1]), friction_end_);
      }
      follow(f, at.df, dv);
      f_[1] = select(open, f[0], f_[1]);
      f_[2] = select(open, f[1], f_[2]);
      for (int j = 0; j < 2; ++j) v[j] = select(open, v[j] + dv[j], v[j]);
      if constexpr (kind == FrictionKind::lugre) {
        follow(at.rate, at.drate, dv);
        dz_[1] = select(open, at.rate[0], dz_[1]);
        dz_[2] = friction_end_ = select(open, at.rate[1], dz_[2]);
      }
      open = open & !(change <= fma(P(1e-13), abs(v[1]), tolerance));
      if (!open.any()) break;
    }
    return !open;
  }

  void find_kink(const Mask& may_have) {
    constexpr double kNoTravel = 1e-14;                   // m: a reversal that moves less is none
    constexpr double kHalvings[] = {3.0, 2.0, 1.0, 1.0};  // by the node after it
    const P zero(0.0), least = P(kNoTravel) / h_;
    for (int node = 3; node >= 0; --node) {
      const P& before = node == 0 ? s_.v : y_[node - 1];
      const Mask crossed = (before * y_[node] < zero) & (abs(y_[node]) > least) & may_have;
      kink = select(crossed, P(kHalvings[node]), kink);
    }
  }

  // Friction need not be computed at h/4 and 3h/4 where a bound of what the parabola misses does.
  void estimate_error(const DriveConstants& c, const Mask& active) {
    const P inverse_mass(c.inverse_mass);
    if (kind == FrictionKind::lugre) {
      error = error_of(inverse_mass);
      return;
    }
    const P bound = bound_of_error(c, inverse_mass);
    const Mask small = bound <= P(c.tolerance);
    error = bound;
    if ((active & !small).any()) error = select(small, bound, error_of(inverse_mass));
  }

  // Speed is a parabola q(s) and at h/4 and 3h/4 a little else. The third derivative of f(q(s)) by
  // s is f_3 q_1^3 + 3 f_2 q_1 q_2, those of f by q and of q by s; s (s - 1/2) (s - 1) / 6 is
  // 1/128.
  P bound_of_error(const DriveConstants& c, const P& inverse_mass) const {
    const P v[3] = {s_.v, y_[1], y_[3]};
    const P first = v[1] - v[0], second = v[2] - v[1];
    const P q_2 = P(4.0) * abs(second - first);
    const P q_1 = P(2.0) * max(abs(first), abs(second)) + q_2;
    const P other =
        max(abs(y_[0] - parabola(kQuarter[0], v)), abs(y_[2] - parabola(kQuarter[1], v)));
    const Mask is_gentle = min(abs(v[0]), min(abs(v[1]), abs(v[2]))) - q_1 > P(c.tanh_end);
    const auto f = [&](std::size_t n) {
      return select(is_gentle, P(c.gentle[n - 1]), P(c.steep[n - 1]));
    };
    const P third = fma(f(3) * q_1, q_1, P(3.0) * f(2) * q_2) * q_1;
    const P most = fma(f(1), other, P(1.0 / 128.0) * third);
    return missed_at_most(most, h_ * inverse_mass * h_, h_ * inverse_mass * P(kMemory));
  }

  // Error of the parabola at h/4 and 3h/4, as the displacement (m) that it causes.
  P error_of(const P& inverse_mass) const {
    const P impulse = h_ * inverse_mass;
    if (kind == FrictionKind::regularised) {
      return missed(load_ + regularised_force(p_, y_[0]), load_ + regularised_force(p_, y_[2]), f_,
                    impulse * h_, impulse * P(kMemory));
    }
    P rate[2], f[2];
    for (int j = 0; j < 2; ++j) {
      const P z = z_at(2 * j);
      rate[j] = bristle_rate(p_, y_[2 * j], z);
      f[j] = load_ + fma(p_.sigma0, z, p_.sigma1 * rate[j]);
    }
    return missed(f[0], f[1], f_, impulse * h_, impulse * P(kMemory)) +
           missed(rate[0], rate[1], dz_, h_, h_);
  }

  const Motion<Arch>& s_;
  const P& load_;
  const FrictionPack<Arch>& p_;
  const ParabolaBlock& block_;
  const P h_;
  P y_[8];                                  // v at the four nodes, i, w, delta, and the way of x
  P f_[3];                                  // N, at 0, h/2, h
  P dz_[3] = {};                            // m/s, there
  P slope_;                                 // N s/m, of f at 0
  P friction_end_ = 0.0, slope_end_ = 0.0;  // as KnownFriction, at h
};

template <class Arch>
Motion<Arch> select(const PackMask<Arch>& mask, const Motion<Arch>& yes, const Motion<Arch>& no) {
  return {select(mask, yes.i, no.i), select(mask, yes.w, no.w), select(mask, yes.delta, no.delta),
          select(mask, yes.v, no.v), select(mask, yes.x, no.x), select(mask, yes.z, no.z)};
}

}  // namespace
}  // namespace servomill::plant

#include "plant/drives/drive_kernel.h"

#include <cstdint>
#include <cstring>
#include <limits>

#include "plant/drives/collocation.h"
#include "plant/vocabulary/pack.h"

// Where eight numbers are one register, what is called is small enough to be put in its place.
#ifdef __AVX512F__
#define SERVOMILL_FLATTEN [[gnu::flatten]]
#else
#define SERVOMILL_FLATTEN
#endif

namespace servomill::plant {
namespace {

LaneBits bits_of(const LaneFlags& flags) {
  std::uint64_t bytes;
  static_assert(sizeof(bytes) == sizeof(flags));
  std::memcpy(&bytes, flags.data(), sizeof(bytes));
  return static_cast<LaneBits>(bytes * 0x0102040810204080 >> 56);  // byte j to bit j
}

// e^x for x <= 0, to the last bit or two, by Taylor's series about the nearest multiple of ln 2.
// Below kLeast it stays: what it is multiplied with must not become subnormal, which is slow.
template <class Arch>
Pack<Arch> exp_of_negative(const Pack<Arch>& x) {
  using P = Pack<Arch>;
  using Bits = xsimd::batch<std::int64_t, Arch>;
  constexpr double kLeast = -200.0;
  constexpr double kRound = 6755399441055744.0;  // 3 2^51: its last bit counts ones
  constexpr double kLog2e = 1.4426950408889634, kLn2 = 0x1.62e42fefa0000p-1;
  constexpr double kLn2Rest = 0x1.cf79abc9e3b39p-40;
  const P y = max(x, P(kLeast));
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

// The friction of eight drives, with the members of FrictionParams. What the lanes that are not
// active have is of no interest.
template <class Arch>
struct FrictionPack {
  using P = Pack<Arch>;
  using Mask = PackMask<Arch>;
  P Fc_positive, Fc_negative, Fs_positive, Fs_negative, sigma0, sigma1, inverse_vs, inverse_v0;
  Mask idle;

  FrictionPack(const DriveConstants& c, LaneBits active)
      : Fc_positive(c.Fc_positive),
        Fc_negative(c.Fc_negative),
        Fs_positive(c.Fs_positive),
        Fs_negative(c.Fs_negative),
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
    constexpr int kMostIterations = 12;
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
    for (int n = 0; n < kMostIterations; ++n) {
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
    constexpr double kHalvings[] = {3.0, 2.0, 1.0, 1.0};  // by the node behind it
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

int log2_of(int n) { return 31 - __builtin_clz(static_cast<unsigned>(n)); }

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

// Through the zone of friction, lane for lane in sub-steps much as ExactStep::advance chooses them;
// those that want one of the same length make it together. Returns the lanes that need shorter
// ones.
template <class Arch, FrictionKind kind, bool same>
[[gnu::noinline]] SERVOMILL_FLATTEN LaneBits in_sub_steps(DriveBlock& s,
                                                          const DriveInputBlock& input,
                                                          const DriveConstants& c,
                                                          const Ladder& ladder, LaneBits lanes) {
  using P = Pack<Arch>;
  using Mask = PackMask<Arch>;
  const Start<Arch> start = start_of<Arch>(s, input, c);
  constexpr int kWhole = 32;  // beyond all rungs
  const FrictionPack<Arch> p(c, lanes);
  const P tolerance(c.tolerance);
  Motion<Arch> now = start.at;
  KnownFriction<Arch> known(s);

  const int all = ladder.ticks << Ladder::kDepth, whole = log2_of(all);
  int wanted[kLaneWidth], rest[kLaneWidth];  // rungs; lengths of the lowest
  LaneBits open = lanes, others = 0;
  for (std::size_t j = 0; j < kLaneWidth; ++j) {
    wanted[j] = c.coarsest[j] - s.control[j].halvings;
    rest[j] = all;
    others |= static_cast<LaneBits>((wanted[j] < 0) << j);
  }
  others &= lanes;
  open &= static_cast<LaneBits>(~others);
  const auto rung_of = [&](std::size_t j) {
    if (rest[j] == all && wanted[j] >= whole) return kWhole;
    const int fits = log2_of(rest[j] | 1);  // 0 of those that have arrived, which is not asked for
    return wanted[j] < fits ? wanted[j] : fits;
  };
  while (open != 0) {
    // whose turn is it?
    LaneBits turn = open;
    const int rung = rung_of(static_cast<std::size_t>(__builtin_ctz(open)));
    for (std::size_t j = 0; j < kLaneWidth; ++j) {
      if (rung_of(j) != rung) turn &= static_cast<LaneBits>(~(1U << j));
    }
    const ParabolaBlock& block = rung == kWhole ? *ladder.whole : ladder.rungs[rung];
    const Mask active = Mask::of(turn);
    const SubStep<Arch, kind, same> step(now, known, start.command, start.load, p, c, block,
                                         active);
    const Mask good = active & step.resolved(tolerance);
    const unsigned accepted = good.bits();
    now = select(good, step.end, now);
    known = select(good, step.friction_at_end(), known);

    // those that arrived, and how far the others go next
    LaneArray error, kink;
    step.error.store(error);
    step.kink.store(kink);
    const int level = rung == kWhole ? whole : rung;
    for (std::size_t j = 0; j < kLaneWidth; ++j) {
      const auto bit = static_cast<LaneBits>(1U << j);
      if (!(turn & bit)) continue;
      if (accepted & bit) {
        rest[j] -= rung == kWhole ? all : 1 << rung;
        if (rest[j] == 0) open &= static_cast<LaneBits>(~bit);
        if (level == wanted[j] && error[j] * 64.0 <= c.tolerance[j]) {
          wanted[j] += error[j] * 4096.0 <= c.tolerance[j] ? 2 : 1;
          if (wanted[j] > c.coarsest[j]) wanted[j] = c.coarsest[j];
        }
      } else {
        wanted[j] = level - (kink[j] > 0.0 ? static_cast<int>(kink[j]) : 1);
        if (wanted[j] >= 0) continue;
        others |= bit;
        open &= static_cast<LaneBits>(~bit);
      }
    }
  }
  const LaneBits arrived = lanes & static_cast<LaneBits>(~others);
  for (std::size_t j = 0; j < kLaneWidth; ++j) {
    if (arrived >> j & 1U) s.control[j].halvings = c.coarsest[j] - wanted[j];
  }
  store(select(Mask::of(arrived), now, motion_of<Arch>(s)), s);
  select(Mask::of(arrived), known, KnownFriction<Arch>(s)).store(s);
  return others;
}

// Destinations of the positions of a block at the stops of a step.
struct Positions {
  LaneArray* first;
  std::size_t block, blocks;

  LaneArray& at(std::size_t stop) const { return first[stop * blocks + block]; }
};

// The step as a whole through the zone of friction. Returns the lanes that took it; the others are
// as they were.
template <class Arch, FrictionKind kind, bool same>
[[gnu::noinline]] SERVOMILL_FLATTEN LaneBits in_one(DriveBlock& s, const DriveInputBlock& input,
                                                    const BlockStep& whole,
                                                    const Positions& positions, LaneBits lanes) {
  using P = Pack<Arch>;
  using Mask = PackMask<Arch>;
  const DriveConstants& c = *whole.constants;
  const Start<Arch> start = start_of<Arch>(s, input, c);
  const FrictionPack<Arch> p(c, lanes);
  const Mask active = Mask::of(lanes);
  const KnownFriction<Arch> known(s);
  const SubStep<Arch, kind, same> step(start.at, known, start.command, start.load, p, c,
                                       *whole.ladder.whole, active);
  const Mask good = active & step.resolved(P(c.tolerance));
  for (std::size_t n = 0; n < whole.stop_count; ++n) {
    LaneArray& x = positions.at(n);
    select(good, step.position_at(whole.stops[n].parabola, start.command), P(x)).store(x);
  }
  store(select(good, step.end, motion_of<Arch>(s)), s);
  select(good, step.friction_at_end(), known).store(s);
  return static_cast<LaneBits>(good.bits());
}

// Drives that did not complete the step in one use shorter sub-steps from now on.
template <class Arch, FrictionKind kind, bool same>
LaneBits through_zone_with_stops(DriveBlock& s, const DriveInputBlock& input, const BlockStep& step,
                                 const Positions& positions, LaneBits lanes) {
  const DriveConstants& c = *step.constants;
  const int whole = log2_of(step.ladder.ticks) + Ladder::kDepth;
  unsigned trying = 0;
  for (std::size_t j = 0; j < kLaneWidth; ++j) {
    const int wanted = c.coarsest[j] - s.control[j].halvings;
    trying |= static_cast<unsigned>((wanted >= step.least_wanted) & (c.coarsest[j] >= whole)) << j;
  }
  trying &= lanes;
  if (trying == 0) return lanes;
  const LaneBits moved =
      in_one<Arch, kind, same>(s, input, step, positions, static_cast<LaneBits>(trying));
  for (unsigned failed = trying & ~moved; failed != 0; failed &= failed - 1U) {
    const int j = __builtin_ctz(failed);
    s.control[static_cast<std::size_t>(j)].halvings =
        c.coarsest[static_cast<std::size_t>(j)] - (step.least_wanted - 1);
  }
  return static_cast<LaneBits>(lanes & ~moved);
}

// As a rule all lanes take the step as a whole. Returns those that are left.
template <class Arch, FrictionKind kind, bool same>
LaneBits through_zone(DriveBlock& s, const DriveInputBlock& input, const BlockStep& step,
                      const Positions& positions, LaneBits lanes) {
  if (step.stop_count != 0) {
    return through_zone_with_stops<Arch, kind, same>(s, input, step, positions, lanes);
  }
  const DriveConstants& c = *step.constants;
  int halvings = 0;
  for (std::size_t j = 0; j < kLaneWidth; ++j) {
    halvings |= s.control[j].halvings & -static_cast<int>(lanes >> j & 1U);
  }
  if (halvings == 0 && c.least_coarsest >= log2_of(step.ladder.ticks) + Ladder::kDepth) {
    lanes &= static_cast<LaneBits>(~in_one<Arch, kind, same>(s, input, step, positions, lanes));
    if (lanes == 0) return 0;
  }
  return in_sub_steps<Arch, kind, same>(s, input, c, step.ladder, lanes);
}

// The positions of the lanes that moved; the others stand.
template <class Arch, bool same>
void hold_at_stops(const BlockStep& step, const Positions& positions, const PackMask<Arch>& moved,
                   const Pack<Arch>& x, const Pack<Arch> (&in)[HoldBlock::kColumns]) {
  for (std::size_t n = 0; n < step.stop_count; ++n) {
    select(moved, x + product<Arch, same>(step.stops[n].hold, 0, in), x).store(positions.at(n));
  }
}

// The end of a step while the force against the slides is constant.
template <class Arch, bool same>
Motion<Arch> held(const HoldBlock& hold, const Motion<Arch>& at,
                  const Pack<Arch> (&in)[HoldBlock::kColumns]) {
  const auto row = [&](std::size_t n) {
    return product<Arch, same>(hold.end, n * HoldBlock::kColumns, in);
  };
  return {row(0), row(1), row(2), row(3), at.x + row(4), at.z};
}

template <class Arch, bool same>
[[gnu::always_inline]] inline void advance_linear(DriveBlock& s, const DriveInputBlock& input,
                                                  const BlockStep& step,
                                                  const Positions& positions) {
  using P = Pack<Arch>;
  const unsigned active = bits_of(input.active);
  const Start<Arch> start = start_of<Arch>(s, input, *step.constants);
  const Motion<Arch>& at = start.at;
  const P in[] = {at.i, at.w, at.delta, at.v, start.command, start.load};
  const Motion<Arch> end = held<Arch, same>(*step.hold, at, in);
  hold_at_stops<Arch, same>(step, positions, PackMask<Arch>::of(active), at.x, in);
  store(active == 0xFFU ? end : select(PackMask<Arch>::of(active), end, at), s);
}

// Returns the active lanes that do not glide all over the step, untouched.
template <class Arch, bool same>
SERVOMILL_FLATTEN unsigned glide(DriveBlock& s, const DriveInputBlock& input, const BlockStep& step,
                                 const Positions& positions, unsigned active) {
  using P = Pack<Arch>;
  using Mask = PackMask<Arch>;
  const DriveConstants& c = *step.constants;
  const HoldBlock& hold = *step.hold;
  const Start<Arch> start = start_of<Arch>(s, input, c);
  const Motion<Arch>& at = start.at;
  const P speed(c.glide_speed), zero(0.0);
  const Mask forwards = at.v > zero;
  const P friction = select(forwards, P(c.Fc_positive), -P(c.Fc_negative));
  const Mask linear = speed < zero;
  Mask moved = (linear | (abs(at.v) > speed)) & Mask::of(active);
  if (c.lugre != 0) {
    constexpr double kSettled = 1e-10;  // of Fc, as Gliding::holds
    moved = moved & (Mask::of(0xFFU & ~c.lugre) |
                     (abs(fma(P(c.sigma0), at.z, -friction)) <= P(kSettled) * abs(friction)));
  }
  if (!moved.any()) {
    for (std::size_t n = 0; n < step.stop_count; ++n) at.x.store(positions.at(n));
    return active;
  }
  const P in[] = {at.i, at.w, at.delta, at.v, start.command, start.load + friction};
  const P middle = product<Arch, same>(hold.middle, 0, in);
  const Motion<Arch> end = held<Arch, same>(hold, at, in);
  // does it glide all over the step?
  const P slowest = select(forwards, min(middle, end.v), -max(middle, end.v));
  moved = moved & (linear | (slowest > speed));
  const unsigned gone = moved.bits();
  hold_at_stops<Arch, same>(step, positions, moved, at.x, in);
  store(gone == 0xFFU ? end : select(moved, end, at), s);
  if (const unsigned modes = c.has_slide_mode & gone; modes != 0) {
    const unsigned up = forwards.bits();
    for (std::size_t j = 0; j < kLaneWidth; ++j) {
      if (!(modes >> j & 1U)) continue;
      s.slide[j] = up >> j & 1U ? SlideMode::positive : SlideMode::negative;
    }
  }
  return active & ~gone;
}

template <class Arch, bool same>
[[gnu::noinline]] LaneBits advance_with_friction(DriveBlock& s, const DriveInputBlock& input,
                                                 const BlockStep& step,
                                                 const Positions& positions) {
  const DriveConstants& c = *step.constants;
  const unsigned active = bits_of(input.active);
  const unsigned stay = glide<Arch, same>(s, input, step, positions, active);
  unsigned others = stay & ~(c.regularised | c.lugre);
  if (const auto lanes = static_cast<LaneBits>(stay & c.regularised)) {
    others |= through_zone<Arch, FrictionKind::regularised, same>(s, input, step, positions, lanes);
  }
  if (const auto lanes = static_cast<LaneBits>(stay & c.lugre)) {
    others |= through_zone<Arch, FrictionKind::lugre, same>(s, input, step, positions, lanes);
  }
  return static_cast<LaneBits>(others);
}

template <class Arch, bool same>
LaneBits advance_block(DriveBlock& s, const DriveInputBlock& input, const BlockStep& step,
                       const Positions& positions) {
  if (!step.constants->linear) return advance_with_friction<Arch, same>(s, input, step, positions);
  advance_linear<Arch, same>(s, input, step, positions);
  return 0;
}

// Only the registers of AVX-512 take one number for all as they read it.
template <class Arch>
LaneBits advance_one(DriveBlock& s, const DriveInputBlock& input, const BlockStep& step,
                     const Positions& positions) {
  if constexpr (Pack<Arch>::kRegisters == 1) {
    if (step.constants->same) return advance_block<Arch, true>(s, input, step, positions);
  }
  return advance_block<Arch, false>(s, input, step, positions);
}

template <class Arch>
SERVOMILL_FLATTEN LanesLeft advance(DriveBlock* states, const DriveInputBlock* inputs,
                                    const BlockStep* steps, LaneArray* positions, std::size_t first,
                                    std::size_t end) {
  for (std::size_t n = first; n < end; ++n) {
    const LaneBits lanes =
        advance_one<Arch>(states[n], inputs[n], steps[n], Positions{positions, n, end});
    if (lanes != 0) return {n, lanes};
  }
  return {end, 0};
}

}  // namespace

template <>
DriveKernel make_drive_kernel<SERVOMILL_LEVEL>() {
  return {&advance<SERVOMILL_ARCH>};
}

}  // namespace servomill::plant

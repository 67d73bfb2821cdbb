#include "plant/drives/drive_kernel.h"

#include <cstdint>
#include <cstring>

#include "plant/drives/drive_pack.h"
#include "plant/drives/sub_step.h"

// With eight numbers in one register, the called functions are small enough to be inlined.
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

int log2_of(int n) { return 31 - __builtin_clz(static_cast<unsigned>(n)); }

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

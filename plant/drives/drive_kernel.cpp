#include "plant/drives/drive_kernel.h"

#include <cstring>

#include "plant/vocabulary/pack.h"

namespace servomill::plant {
namespace {

template <class Arch>
PackMask<Arch> mask_of(const LaneFlags& flags) {
  LaneArray numbers;
  for (std::size_t j = 0; j < kLaneWidth; ++j) numbers[j] = flags[j] ? 1.0 : 0.0;
  return Pack<Arch>(numbers) != Pack<Arch>(0.0);
}

template <class Arch>
LaneBits bits_of(const PackMask<Arch>& mask) {
  if (!mask.any()) return 0;
  LaneArray numbers;
  select(mask, Pack<Arch>(1.0), Pack<Arch>(0.0)).store(numbers);
  unsigned bits = 0;
  for (std::size_t j = 0; j < kLaneWidth; ++j) bits |= (numbers[j] != 0.0 ? 1U : 0U) << j;
  return static_cast<LaneBits>(bits);
}

bool all_of(const LaneFlags& flags) {
  constexpr std::uint64_t kAll = 0x0101010101010101;
  std::uint64_t bytes;
  static_assert(sizeof(bytes) == sizeof(flags));
  std::memcpy(&bytes, flags.data(), sizeof(bytes));
  return bytes == kAll;
}

// The sum over the columns of a row, in their order.
template <class Arch>
Pack<Arch> product(const LaneArray* row, const Pack<Arch> (&in)[HoldBlock::kColumns]) {
  Pack<Arch> sum = Pack<Arch>(row[0]) * in[0];
#pragma GCC unroll 8
  for (std::size_t column = 1; column < HoldBlock::kColumns; ++column) {
    sum = fma(Pack<Arch>(row[column]), in[column], sum);
  }
  return sum;
}

template <class Arch>
LaneBits advance(DriveBlock& s, const DriveInputBlock& input, const HoldBlock& hold,
                 const DriveConstants& c) {
  using P = Pack<Arch>;
  using Mask = PackMask<Arch>;
  constexpr std::size_t kColumns = HoldBlock::kColumns;

  // the force of those that glide; linear drives have none
  const P v(s.v), speed(c.glide_speed), zero(0.0);
  const Mask forwards = v > zero;
  const P friction = select(forwards, P(c.Fc_positive), -P(c.Fc_negative));
  Mask glides = abs(v) > speed;
  if (c.has_bristles) {
    constexpr double kSettled = 1e-10;  // of Fc, as Gliding::holds
    const P sigma0(c.sigma0);
    glides = glides & ((sigma0 == zero) |
                       (abs(fma(sigma0, P(s.z), -friction)) <= P(kSettled) * abs(friction)));
  }

  const P in[kColumns] = {P(s.i), P(s.w),           P(s.delta),
                          v,      P(input.command), P(input.F) + P(c.F_load) + friction};
  const P middle = product<Arch>(hold.middle.data(), in);
  P out[HoldBlock::kRows];
#pragma GCC unroll 8
  for (std::size_t row = 0; row < HoldBlock::kRows; ++row) {
    out[row] = product<Arch>(&hold.end[row * kColumns], in);
  }
  out[4] += P(s.x);

  // does it glide all over the step?
  const P slowest = select(forwards, min(middle, out[3]), -max(middle, out[3]));
  glides = glides & (slowest > speed);
  Mask moved = (speed < zero) | glides;
  LaneBits others = 0;
  if (!all_of(input.active)) {
    const Mask active = mask_of<Arch>(input.active);
    others = bits_of<Arch>(active & !moved);
    moved = moved & active;
  } else if (!moved.all()) {
    others = bits_of<Arch>(!moved);
  }
  if (const LaneBits modes = c.has_slide_mode; modes != 0) {
    const LaneBits up = bits_of<Arch>(moved & forwards), down = bits_of<Arch>(moved & !forwards);
    for (std::size_t j = 0; j < kLaneWidth; ++j) {
      if ((modes & up) >> j & 1U) s.slide[j] = SlideMode::positive;
      if ((modes & down) >> j & 1U) s.slide[j] = SlideMode::negative;
    }
  }
  select(moved, out[0], in[0]).store(s.i);
  select(moved, out[1], in[1]).store(s.w);
  select(moved, out[2], in[2]).store(s.delta);
  select(moved, out[3], v).store(s.v);
  select(moved, out[4], P(s.x)).store(s.x);
  return others;
}

}  // namespace

template <>
DriveKernel make_drive_kernel<SERVOMILL_LEVEL>() {
  return {&advance<SERVOMILL_ARCH>};
}

}  // namespace servomill::plant

#include "plant/drives/drive_bank.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>

namespace servomill::plant {
namespace {

// Bounds of the derivatives of regularised friction, the first to the third: of the Stribeck term
// alone (0.86, 2, 4 over powers of vs, times its height D) and with tanh (1, 0.77, 2 over powers of
// v0, times the greater of Fs and Fc). Viscous friction adds b v tanh(v / v0), whose derivatives
// are at most 1.2 b, 2 b / v0 and 4 b / v0^2.
struct SlopeBounds {
  std::array<double, 3> steep, gentle;

  explicit SlopeBounds(const FrictionParams& f) {
    const double D =
        std::max(std::abs(f.Fs_positive - f.Fc_positive), std::abs(f.Fs_negative - f.Fc_negative));
    const double A = std::max({f.Fs_positive, f.Fs_negative, f.Fc_positive, f.Fc_negative});
    const double a = 1.0 / f.vs, b = 1.0 / f.v0, viscous = std::max(f.b_positive, f.b_negative);
    gentle = {0.86 * D * a, 2.0 * D * a * a, 4.0 * D * a * a * a};
    steep = {
        gentle[0] + A * b, gentle[1] + 2.0 * gentle[0] * b + 0.77 * A * b * b,
        gentle[2] + 3.0 * gentle[1] * b + 3.0 * 0.77 * gentle[0] * b * b + 2.0 * A * b * b * b};
    steep[0] += 1.2 * viscous;
    steep[1] += 2.0 * viscous * b;
    steep[2] += 4.0 * viscous * b * b;
    gentle[0] += viscous;
  }
};

// Columns of a HoldBlock without the position: nothing depends on it, and it is counted from its
// last value.
constexpr Eigen::Index kHoldColumns[] = {0, 1, 2, 3, 5, 6};

// Calls what(n, ticks) of the pieces from stop to stop, the last one up to the end.
template <class What>
void each_piece(const Stretch& stretch, What what) {
  Tick from = 0;
  for (std::size_t n = 0; n <= stretch.stops.size(); ++n) {
    const Tick to = n < stretch.stops.size() ? stretch.stops[n] : stretch.step;
    what(n, to - from);
    from = to;
  }
}

}  // namespace

DriveBank::DriveBank(std::span<const FeedDriveParams> lanes, double base_period,
                     std::span<const Tick> steps, PreparedDrives* kept, SimdLevel level,
                     std::span<const Stretch> stretches)
    : stretches_(stretches.begin(), stretches.end()),
      kernel_(at_simd_level(level, []<SimdLevel l>() { return make_drive_kernel<l>(); })) {
  steps_.assign(steps.begin(), steps.end());
  for (const Stretch& stretch : stretches_) {
    steps_.push_back(stretch.step);
    each_piece(stretch, [&](std::size_t, Tick piece) { steps_.push_back(piece); });
  }
  std::sort(steps_.begin(), steps_.end());
  steps_.erase(std::unique(steps_.begin(), steps_.end()), steps_.end());
  assert(steps_.empty() || steps_.front() > 0);
  PreparedDrives own(lanes.size());
  for (const FeedDriveParams& params : lanes) {
    drives_.push_back((kept != nullptr ? *kept : own).get(params, base_period, steps_, stretches_));
    inverse_r_.push_back(1.0 / params.r);
  }
  constants_.resize(blocks_of(lanes.size()));
  holds_.resize(steps_.size() * constants_.size());
  parabolas_.resize(constants_.size());
  for (std::size_t block = 0; block < constants_.size(); ++block) prepare_block(block);
  for (std::size_t step = 0; step < steps_.size(); ++step) {
    first_of_step_.resize(static_cast<std::size_t>(steps_[step]) + 1, -1);
    first_of_step_.back() = static_cast<int>(block_steps_.size());
    for (std::size_t block = 0; block < constants_.size(); ++block) {
      block_steps_.push_back({&holds_[block_steps_.size()], &constants_[block],
                              Ladder{.ticks = static_cast<int>(steps_[step])}});
      const std::vector<ParabolaBlock>& parabolas = parabolas_[block];
      if (parabolas.empty()) continue;
      block_steps_.back().ladder.whole = &parabolas[step];
      block_steps_.back().ladder.rungs = &parabolas[steps_.size()];
    }
  }
  prepare_stretches();
}

void DriveBank::prepare_stretches() {
  std::size_t stop_count = 0;
  for (const Stretch& stretch : stretches_) stop_count += stretch.stops.size();
  stops_.resize(stop_count * constants_.size());
  for (std::size_t l = 0; l < lanes(); ++l) {
    StopBlock* to = stops_.data() + l / kLaneWidth * stop_count;
    for (const PreparedDrive::Stop& from : drives_[l]->stops) {
      for (std::size_t column = 0; column < HoldBlock::kColumns; ++column) {
        to->hold.set(column, l % kLaneWidth, from.hold[kHoldColumns[column]]);
      }
      for (std::size_t column = 0; column < ParabolaBlock::kColumns; ++column) {
        to->parabola.set(column, l % kLaneWidth, from.parabola[column]);
      }
      ++to;
    }
  }
  std::size_t first = 0;
  for (const Stretch& stretch : stretches_) {
    Tick longest_piece = 0;
    each_piece(stretch,
               [&](std::size_t, Tick piece) { longest_piece = std::max(longest_piece, piece); });
    const auto rung = [](Tick step) {
      return static_cast<int>(std::bit_width(static_cast<std::uint64_t>(step))) - 1 +
             Ladder::kDepth;
    };
    for (std::size_t block = 0; block < constants_.size(); ++block) {
      BlockStep step = steps_of(stretch.step)[block];
      step.stops = stops_.data() + block * stop_count + first;
      step.stop_count = stretch.stops.size();
      // what the pieces may grow to, or more where they would not show that it does
      step.least_wanted = std::min(rung(stretch.step), rung(longest_piece) + 1);
      stretch_steps_.push_back(step);
    }
    first += stretch.stops.size();
  }
}

void DriveBank::prepare_block(std::size_t block) {
  constants_[block].glide_speed.fill(-1.0);  // linear, as are the lanes that fill the last block
  const std::size_t first = block * kLaneWidth;
  const std::size_t count = std::min(kLaneWidth, lanes() - first);
  bool same = count == kLaneWidth;
  for (std::size_t j = 0; j < count; ++j) {
    prepare_lane(block, j, *drives_[first + j]);
    same = same && drives_[first + j] == drives_[first];
  }
  constants_[block].same = same;
}

void DriveBank::prepare_lane(std::size_t block, std::size_t j, const PreparedDrive& drive) {
  DriveConstants& c = constants_[block];
  const FeedDriveParams& p = drive.params;
  c.F_load[j] = p.F_load;
  for (std::size_t step = 0; step < steps_.size(); ++step) {
    HoldBlock& hold = holds_[step * constants_.size() + block];
    const PreparedDrive::Hold& from = drive.hold[step];
    for (std::size_t column = 0; column < HoldBlock::kColumns; ++column) {
      for (std::size_t row = 0; row < HoldBlock::kRows; ++row) {
        hold.end.set(row * HoldBlock::kColumns + column, j,
                     from.end(static_cast<Eigen::Index>(row), kHoldColumns[column]));
      }
      hold.middle.set(column, j, from.middle(kHoldColumns[column]));
    }
  }
  if (!drive.exact) return;
  c.linear = false;
  c.glide_speed[j] = drive.exact->gliding().speed;
  const auto bit = static_cast<LaneBits>(1U << j);
  const FrictionParams& f = p.friction;
  if (f.kind == FrictionKind::set_valued) c.has_slide_mode |= bit;
  c.Fc_positive[j] = f.Fc_positive;
  c.Fc_negative[j] = f.Fc_negative;
  if (!drive.smooth()) return;
  (f.kind == FrictionKind::lugre ? c.lugre : c.regularised) |= bit;
  if (drive.exact->has_kink()) c.has_kink |= bit;
  c.Fs_positive[j] = f.Fs_positive;
  c.Fs_negative[j] = f.Fs_negative;
  c.b_positive[j] = f.b_positive;
  c.b_negative[j] = f.b_negative;
  c.inverse_vs[j] = 1.0 / f.vs;
  c.inverse_v0[j] = 1.0 / f.v0;
  c.sigma0[j] = f.sigma0;
  c.sigma1[j] = f.sigma1;
  c.inverse_mass[j] = 1.0 / p.slide_mass();
  // A step as a whole may be twice as long as the exact step's longest sub-step: more may add up.
  constexpr double kShare = 0.25;
  c.tolerance[j] = kShare * drive.exact->resolution().tolerance;
  c.coarsest[j] = drive.exact->coarsest_log2() + Ladder::kDepth;
  c.least_coarsest = std::min(c.least_coarsest, c.coarsest[j]);

  const SlopeBounds bounds(f);
  for (std::size_t n = 0; n < 3; ++n) {
    c.steep[n][j] = bounds.steep[n];
    c.gentle[n][j] = bounds.gentle[n];
  }
  c.tanh_end[j] = kTanhEnd * f.v0;
  prepare_parabolas(block, j, drive);
}

void DriveBank::prepare_parabolas(std::size_t block, std::size_t j, const PreparedDrive& drive) {
  std::vector<ParabolaBlock>& parabolas = parabolas_[block];
  parabolas.resize(drive.whole.size() + drive.rungs.size());
  const auto copy = [&](ParabolaBlock& to, const Propagator& from, double h) {
    to.h = h;
    to.speed_tolerance[j] = drive.exact->speed_tolerance();
    for (std::size_t row = 0; row < ParabolaBlock::kRows; ++row) {
      for (std::size_t column = 0; column < ParabolaBlock::kColumns; ++column) {
        to.rows.set(row * ParabolaBlock::kColumns + column, j, from.slide[column][row]);
      }
    }
  };
  ParabolaBlock* to = parabolas.data();
  for (std::size_t n = 0; n < drive.whole.size(); ++n) {
    copy(*to++, drive.whole[n], static_cast<double>(steps_[n]) * drive.base_period);
  }
  for (std::size_t n = 0; n < drive.rungs.size(); ++n) {
    copy(*to++, drive.rungs[n],
         std::ldexp(drive.base_period, static_cast<int>(n) - Ladder::kDepth));
  }
}

void DriveBank::advance_rest(DriveState& s, const DriveInput& input, Tick step,
                             const BlockStep* steps, LanesLeft left) const {
  const std::size_t end = constants_.size();
  while (left.block != end) {
    advance_lanes(s, input.blocks[left.block], step, left);
    left =
        kernel_.advance(s.blocks.data(), input.blocks.data(), steps, nullptr, left.block + 1, end);
  }
}

void DriveBank::advance_lanes(DriveState& s, const DriveInputBlock& in, Tick step,
                              LanesLeft left) const {
  for (unsigned lanes = left.lanes; lanes != 0; lanes &= lanes - 1U) {
    const auto j = static_cast<std::size_t>(std::countr_zero(lanes));
    const std::size_t l = left.block * kLaneWidth + j;
    LaneState lane = s.lane(l);
    drives_[l]->exact->advance(lane, in.command[j], in.F[j], step);
    s.set_lane(l, lane);
  }
}

void DriveBank::advance_with_stops(DriveState& s, const DriveInput& input, std::size_t stretch,
                                   std::span<LaneArray> positions) const {
  const std::size_t end = constants_.size();
  assert(s.blocks.size() == end && input.blocks.size() == end && stretch < stretches_.size());
  assert(positions.size() >= stretches_[stretch].stops.size() * end);
  const BlockStep* const steps = &stretch_steps_[stretch * end];
  for (std::size_t first = 0; first < end; ++first) {
    const LanesLeft left =
        kernel_.advance(s.blocks.data(), input.blocks.data(), steps, positions.data(), first, end);
    if (left.block == end) return;
    advance_in_pieces(s, input.blocks[left.block], stretches_[stretch], positions, left);
    first = left.block;
  }
}

// Lanes that are left of a stretch, from stop to stop.
void DriveBank::advance_in_pieces(DriveState& s, const DriveInputBlock& of_all,
                                  const Stretch& stretch, std::span<LaneArray> positions,
                                  LanesLeft left) const {
  DriveInputBlock input = of_all;
  for (std::size_t j = 0; j < kLaneWidth; ++j) input.active[j] = left.lanes >> j & 1U;
  DriveBlock& block = s.blocks[left.block];
  each_piece(stretch, [&](std::size_t n, Tick piece) {
    const LanesLeft others =
        kernel_.advance(&block, &input, steps_of(piece) + left.block, nullptr, 0, 1);
    if (others.block == 0) advance_lanes(s, input, piece, {left.block, others.lanes});
    if (n == stretch.stops.size()) return;
    LaneArray& at_stop = positions[n * constants_.size() + left.block];
    for (std::size_t j = 0; j < kLaneWidth; ++j) {
      if (input.active[j]) at_stop[j] = block.x[j];
    }
  });
}

DriveState DriveBank::at_rest(std::span<const double> x) const {
  assert(x.size() == lanes());
  DriveState s(lanes());
  for (std::size_t l = 0; l < lanes(); ++l) s.set_lane(l, plant::at_rest(drives_[l]->params, x[l]));
  return s;
}

}  // namespace servomill::plant

#include "plant/drives/drive_bank.h"

#include <algorithm>
#include <bit>
#include <cassert>

namespace servomill::plant {

DriveBank::DriveBank(std::span<const FeedDriveParams> lanes, double base_period,
                     std::span<const Tick> steps, PreparedDrives* kept)
    : kernel_(at_simd_level(simd_level(),
                            []<SimdLevel level>() { return make_drive_kernel<level>(); })) {
  std::vector<Tick> distinct(steps.begin(), steps.end());
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  assert(distinct.empty() || distinct.front() > 0);
  for (const Tick& step : distinct) {
    index_of_step_.resize(static_cast<std::size_t>(step) + 1, -1);
    index_of_step_.back() = static_cast<int>(&step - distinct.data());
  }
  PreparedDrives own(lanes.size());
  for (const FeedDriveParams& params : lanes) {
    drives_.push_back((kept != nullptr ? *kept : own).get(params, base_period, distinct));
    inverse_r_.push_back(1.0 / params.r);
  }
  constants_.resize(blocks_of(lanes.size()));
  holds_.resize(distinct.size() * constants_.size());
  for (std::size_t block = 0; block < constants_.size(); ++block) prepare_block(block);
}

void DriveBank::prepare_block(std::size_t block) {
  DriveConstants& c = constants_[block];
  c.glide_speed.fill(-1.0);  // linear, as are the lanes that fill the last block: all zero
  const std::size_t first = block * kLaneWidth;
  for (std::size_t j = 0; j < std::min(kLaneWidth, lanes() - first); ++j) {
    const PreparedDrive& drive = *drives_[first + j];
    c.F_load[j] = drive.params.F_load;
    if (drive.exact) {
      const Gliding& gliding = drive.exact->gliding();
      c.glide_speed[j] = gliding.speed;
      c.Fc_positive[j] = gliding.Fc_positive;
      c.Fc_negative[j] = gliding.Fc_negative;
      c.sigma0[j] = gliding.sigma0;
      c.has_bristles |= gliding.sigma0 != 0.0;
      if (drive.params.friction.kind == FrictionKind::set_valued) {
        c.has_slide_mode |= static_cast<LaneBits>(1U << j);
      }
    }
    for (std::size_t step = 0; step < drive.steps.size(); ++step) {
      HoldBlock& hold = holds_[step * constants_.size() + block];
      const PreparedDrive::Hold& from = drive.hold[step];
      // without the position, which nothing depends on and which is counted from where it was
      constexpr Eigen::Index kColumn[] = {0, 1, 2, 3, 5, 6};
      for (std::size_t column = 0; column < HoldBlock::kColumns; ++column) {
        for (std::size_t row = 0; row < HoldBlock::kRows; ++row) {
          hold.end[row * HoldBlock::kColumns + column][j] =
              from.end(static_cast<Eigen::Index>(row), kColumn[column]);
        }
        hold.middle[column][j] = from.middle(kColumn[column]);
      }
    }
  }
}

void DriveBank::advance(DriveState& s, const DriveInput& input, Tick step) const {
  assert(static_cast<std::size_t>(step) < index_of_step_.size());
  assert(s.blocks.size() == constants_.size() && input.blocks.size() == constants_.size());
  const int index = index_of_step_[static_cast<std::size_t>(step)];
  assert(index >= 0);
  for (std::size_t block = 0; block < constants_.size(); ++block) {
    const DriveInputBlock& in = input.blocks[block];
    LaneBits others = kernel_.advance(
        s.blocks[block], in, hold(static_cast<std::size_t>(index), block), constants_[block]);
    while (others != 0) {
      const auto j = static_cast<std::size_t>(std::countr_zero(others));
      others &= static_cast<LaneBits>(others - 1U);
      const std::size_t l = block * kLaneWidth + j;
      LaneState lane = s.lane(l);
      drives_[l]->exact->advance(lane, in.command[j], in.F[j], step);
      s.set_lane(l, lane);
    }
  }
}

DriveState DriveBank::at_rest(std::span<const double> x) const {
  assert(x.size() == lanes());
  DriveState s(lanes());
  for (std::size_t l = 0; l < lanes(); ++l) s.set_lane(l, plant::at_rest(drives_[l]->params, x[l]));
  return s;
}

}  // namespace servomill::plant

#include "plant/drives/cvode_bank.h"

#include <cassert>

namespace servomill::plant {

CvodeBank::CvodeBank(std::span<const FeedDriveParams> lanes, double base_period)
    : base_period_(base_period) {
  drives_.reserve(lanes.size());
  for (const FeedDriveParams& params : lanes) {
    const double factor = params.solver_tolerance / kSolverTolerance;
    drives_.emplace_back(params, CvodeTolerances{}.times(factor));
  }
}

void CvodeBank::advance(DriveState& state, const DriveInput& input, Tick step) {
  assert(input.blocks.size() == blocks_of(drives_.size()));
  const double duration = static_cast<double>(step) * base_period_;
  for (std::size_t l = 0; l < drives_.size(); ++l) {
    const DriveInputBlock& in = input.blocks[l / kLaneWidth];
    const std::size_t j = l % kLaneWidth;
    if (!in.active[j]) continue;
    LaneState lane = state.lane(l);
    drives_[l].advance(lane, in.command[j], in.F[j], duration);
    state.set_lane(l, lane);
  }
}

}  // namespace servomill::plant

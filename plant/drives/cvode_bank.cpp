#include "plant/drives/cvode_bank.h"

namespace servomill::plant {

CvodeBank::CvodeBank(const std::array<FeedDriveParams, kJoints>& params,
                     const std::array<bool, kJoints>& present, double base_period)
    : base_period_(base_period) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (present[j]) drives_[j].emplace(params[j]);
  }
}

void CvodeBank::advance(DriveState& state, const DriveInput& input, Tick step) {
  for (std::size_t j = 0; j < kJoints; ++j) {
    if (!drives_[j]) continue;
    LaneState lane = state.lane(j);
    drives_[j]->advance(lane, input.command[j], input.F[j],
                        static_cast<double>(step) * base_period_);
    state.set_lane(j, lane);
  }
}

}  // namespace servomill::plant

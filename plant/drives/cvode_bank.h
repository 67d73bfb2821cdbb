/// Drives in lanes, integrated by SUNDIALS: for a scenario that asks for it.
#pragma once

#include <span>
#include <vector>

#include "plant/drives/cvode_drive.h"
#include "plant/vocabulary/ticks.h"

namespace servomill::plant {

/// Does what DriveBank does, some hundred times slower and independently of it.
class CvodeBank {
 public:
  /// @param lanes        one entry per lane
  /// @param base_period  s
  CvodeBank(std::span<const FeedDriveParams> lanes, double base_period);

  /// Moves the active lanes by `step` ticks.
  /// @throws std::runtime_error if CVODE fails
  void advance(DriveState& state, const DriveInput& input, Tick step);

 private:
  double base_period_;
  std::vector<CvodeDrive> drives_;
};

}  // namespace servomill::plant

/// All drives of a machine, integrated by SUNDIALS: for a scenario that asks for it.
#pragma once

#include <array>
#include <optional>

#include "plant/drives/cvode_drive.h"
#include "plant/vocabulary/ticks.h"

namespace servomill::plant {

/// Does what DriveBank does, some hundred times slower and independently of it.
class CvodeBank {
 public:
  /// @param params       one entry per joint; joints that the machine lacks stay at zero
  /// @param present      which joints there are
  /// @param base_period  s
  CvodeBank(const std::array<FeedDriveParams, kJoints>& params,
            const std::array<bool, kJoints>& present, double base_period);

  /// Moves the state by `step` ticks.
  /// @throws std::runtime_error if CVODE fails
  void advance(DriveState& state, const DriveInput& input, Tick step);

 private:
  double base_period_;
  std::array<std::optional<CvodeDrive>, kJoints> drives_;
};

}  // namespace servomill::plant

/// All drives of a machine, moved between instants of the base clock.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "plant/drives/feed_drive.h"
#include "plant/vocabulary/ticks.h"

namespace servomill::plant {

/// Exact propagator of all drives of a machine between instants of the base clock:
///   x(t + h) = exp(A h) x(t) + int_0^h exp(A s) ds B u.
/// Matrices are prepared once for every step length that the schedule contains.
class DriveBank {
 public:
  /// @param params       one entry per joint; joints that the machine lacks stay at zero
  /// @param present      which joints there are
  /// @param base_period  s
  /// @param steps        step lengths that `advance` will be asked for, in ticks
  DriveBank(const std::array<FeedDriveParams, kJoints>& params,
            const std::array<bool, kJoints>& present, double base_period,
            std::span<const Tick> steps);

  /// Moves the state by `step` ticks. @pre step is one of those given at construction
  void advance(DriveState& state, const DriveInput& input, Tick step) const;

  /// Motor angle (rad) of a joint: (delta + x) / r.
  double motor_angle(const DriveState& state, std::size_t joint) const {
    return (state.delta[joint] + state.x[joint]) * inverse_r_[joint];
  }

  /// At rest at x = Q, holding the constant load.
  DriveState at_rest(const Joints& Q) const;

 private:
  static constexpr std::size_t kStates = 5;
  static constexpr std::size_t kColumns = kStates + 2;  // states, command, F
  struct StepMatrix {
    std::array<DriveState::Lanes, kStates * kColumns> coefficient{};
  };

  std::array<FeedDriveParams, kJoints> params_;
  std::array<bool, kJoints> present_;
  DriveState::Lanes inverse_r_{};
  DriveState::Lanes F_load_{};
  std::vector<int> matrix_of_step_;  // -1: not prepared
  std::vector<StepMatrix> matrices_;
};

}  // namespace servomill::plant

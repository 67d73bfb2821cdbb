/// All drives of a machine, moved between instants of the base clock.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "plant/drives/exact_step.h"
#include "plant/drives/feed_drive.h"
#include "plant/vocabulary/ticks.h"

namespace servomill::plant {

/// Exact propagator of all drives of a machine between instants of the base clock:
///   x(t + h) = exp(A h) x(t) + int_0^h exp(A s) ds B u.
/// Matrices are prepared once for every step length that the schedule contains. A joint that is not
/// linear takes part with its friction as a constant force while it glides (struct Gliding);
/// else it is moved by its ExactStep.
class DriveBank {
 public:
  /// @param params       one entry per joint; joints that the machine lacks stay at zero
  /// @param present      which joints there are
  /// @param base_period  s
  /// @param steps        step lengths that `advance` will be asked for, in ticks; none: it will not
  ///                     be called, nor anything prepared for it
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

  /// Sub-steps of a joint that missed their tolerance since the state began: more than 0 means that
  /// its result is not to be trusted.
  static std::uint32_t unresolved(const DriveState& state, std::size_t joint) {
    return state.control[joint].unresolved;
  }

 private:
  static constexpr std::size_t kStates = 5;
  static constexpr std::size_t kColumns = kStates + 2;  // states, command, F
  struct StepMatrix {
    std::array<DriveState::Lanes, kStates * kColumns> coefficient{};
    std::array<DriveState::Lanes, kColumns> middle{};  // v at half the step
  };
  struct Nonlinear {
    std::size_t joint;
    Gliding gliding;
    ExactStep exact;
  };
  using Columns = std::array<const DriveState::Lanes*, kColumns>;

  static DriveState::Lanes product(const DriveState::Lanes* row, const Columns& in);

  std::array<FeedDriveParams, kJoints> params_;
  std::array<bool, kJoints> present_;
  DriveState::Lanes inverse_r_{};
  DriveState::Lanes F_load_{};
  std::vector<int> matrix_of_step_;  // -1: not prepared
  std::vector<StepMatrix> matrices_;
  std::vector<Nonlinear> nonlinear_;
};

}  // namespace servomill::plant

/// Feed drive: current loop, motor with screw, elastic transmission, slide. Linear; friction other
/// than viscous acts as an external force.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/ticks.h"

namespace servomill::plant {

enum class DriveKind : std::uint8_t { two_mass, rigid };

/// Constant description of one feed drive. For a rotary axis read rad for m, N m for N, kg m^2 for
/// kg; a direct drive has r = 1.
///
///            i_cmd          tau = Kt i           r phi - x
///     o---[1/(T_i s + 1)]---(J, b_motor)---r---[k, c]---(M, b_load)--- x
///                              phi                          ^ F_load
struct FeedDriveParams {
  DriveKind kind = DriveKind::two_mass;
  double r = 1.0;        // m/rad, slide travel per motor angle: lead / (2 pi)
  double J = 0.0;        // kg m^2, motor and screw
  double M = 0.0;        // kg, slide with everything it carries
  double k = 0.0;        // N/m, between screw and slide (two_mass)
  double c = 0.0;        // N s/m, the same (two_mass)
  double b_motor = 0.0;  // N m s/rad, viscous friction of the motor
  double b_load = 0.0;   // N s/m, viscous friction of the slide
  double Kt = 1.0;       // N m/A, torque constant
  double i_max = 0.0;    // A, limit of the current command
  double T_i = 0.0;      // s, closed current loop as first-order lag; 0: none
  double F_load = 0.0;   // N, constant force on the slide, counted against +x

  /// Inertia that the motor sees (kg m^2): J + M r^2.
  double J_total() const { return J + M * r * r; }
};

/// State of the drives of one machine: structure of arrays, one lane per joint.
struct DriveState {
  using Lanes = std::array<double, kJoints>;
  Lanes i{};      // A, torque-forming current
  Lanes w{};      // rad/s, motor speed
  Lanes delta{};  // m, wind-up r phi - x (carried instead of phi: no cancellation)
  Lanes v{};      // m/s, slide
  Lanes x{};      // m, slide
};

/// Inputs, constant over a step (zero-order hold).
struct DriveInput {
  DriveState::Lanes i_cmd{};  // A
  DriveState::Lanes F{};      // N, force against the slide beside the constant F_load
};

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

  /// At rest at x = Q, holding the constant load: current and wind-up in equilibrium.
  DriveState at_rest(const Joints& Q) const;

 private:
  static constexpr std::size_t kStates = 5;
  static constexpr std::size_t kColumns = kStates + 2;  // states, i_cmd, F
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

/// dx/dt = A x + B (i_cmd, F) of one drive, states (i, w, delta, v, x). Columns 5 and 6 hold B.
/// The same right-hand side for the exact propagator and for reference integrators.
Eigen::Matrix<double, 5, 7> drive_equations(const FeedDriveParams& params);

}  // namespace servomill::plant

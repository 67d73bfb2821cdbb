/// Displacement of all joints that imposes identified errors of tip and tool axis or compensates
/// them: rotary axes take what turns the tool axis, linear axes the rest, what those turns do to
/// the tip included, so that nothing is corrected twice.
///
/// With the Jacobian of the ideal machine at Q (linear joints l, rotary joints r) and the wanted
/// change s_p of the tip and s_k of the tool axis,
///
///     J_kr dr = s_k               by least squares
///     J_pl dl = s_p - J_pr dr
///
/// If the smaller singular value of J_kr falls below sigma_0, the angle that hardly matters
/// there would have to turn far for little. It then counts what it turns: |J_kr dr - s_k|^2 +
/// lambda^2 |dr|^2 is smallest, with
///
///     lambda = (sigma_0 / 2) (1 - sigma^2 / sigma_0^2),   0 from sigma_0 on
///
/// in its direction. With x = sigma / sigma_0 < 1 the angle then turns by 4 x / (1 + x^2)^2 /
/// sigma_0 of what is asked for, 1.3 / sigma_0 at most, and leaves the share
/// ((1 - x^2) / (1 + x^2))^2 of it. Displacements change smoothly through a singular direction.
/// Source of the damping: Nakamura and Hanafusa, Inverse kinematic solutions with singularity
/// robustness for robot manipulator control, ASME J. Dyn. Sys. Meas. Control 108 (1986) 163-171.
#pragma once

#include "strategies/axis_displacement.h"
#include "strategies/strategy.h"

namespace servomill::strategies {

/// Constant after construction. Calls do not allocate.
class PoseCompensation {
 public:
  /// @param identified     must outlive this
  /// @param sigma_0    see above; for machines whose axes are orthogonal the sine of the angle to
  ///                   the singular direction; > 0
  PoseCompensation(const IdentifiedMachine& identified, Iterations iterations, double sigma_0);

  /// Displacement of the setpoint (5; m, rad) for the programmed position Q.
  ///   impose:              F_i(Q + d) = F_ni(Q)
  ///   compensate:          F_ni(Q + d) = F_i(Q), the non-ideal inverse
  /// With one iteration both are of first order, and each the negative of the other.
  Joints of_setpoint(Action action, const Joints& Q) const;

  /// Displacement of the reading (5; m, rad) for the measured position Q: the axes move by its
  /// negative.
  ///   compensate:          F_i(Q + d) = F_ni(Q), the reading says where the tool is
  ///   impose:              F_ni(Q + d) = F_i(Q), the error where the program is
  Joints of_feedback(Action action, const Joints& Q) const;

  /// Residual of the errors when the axes stand at Q + d instead of Q.
  Residual residual(const Joints& Q, const Joints& d) const;

 private:
  enum class Wanted { errors, removal };
  Joints displacement(Wanted wanted, const Joints& Q) const;

  const IdentifiedMachine& identified_;
  Iterations iterations_;
  double sigma_0_;
};

/// Displacement of all joints (5; m, rad) that changes the pose of the ideal machine at Q by s_p
/// (m) and s_k, to first order.
/// @param sigma_0  of PoseCompensation
Joints displacement_for(const plant::MachineChain& chain, const Joints& Q,
                        const Eigen::Vector3d& p_ST, double sigma_0, const Eigen::Vector3d& s_p,
                        const Eigen::Vector3d& s_k);

/// Residual at the programmed position Q of identified errors that are corrected as well as the
/// axes can, however many iterations that takes: on linear axes what turns the tool, on rotary ones
/// what they cannot turn or, near a singular direction, give way to.
/// @param sigma_0  of PoseCompensation, where axes is all
Residual uncorrectable(const IdentifiedMachine& identified, DisplacedAxes axes, double sigma_0,
                       const Joints& Q);
/// The same for a strategy: nullopt where it generates errors.
std::optional<Residual> uncorrectable(const IdentifiedMachine& identified, Action action,
                                      DisplacedAxes axes, double sigma_0, const Joints& Q);

}  // namespace servomill::strategies

/// Machine as tool centre point control sees it: the tip from the axis positions, and the axis
/// positions from the tip and the tool axis.
///
/// A program under such control speaks of *tip words*: X Y Z are the tip in the workpiece frame W
/// (p_WT), A B C the positions of the rotary axes. Machine words are positions of all axes. With
/// the rotary axes at zero they differ by the tool, p_ST.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plant/kinematics/inverse.h"
#include "plant/vocabulary/axes.h"

namespace servomill::controllers {

/// Share of the tolerance of the tool axis that the chords of great circles take in the planner's
/// ToolCentrePoint.
inline constexpr double kGreatCircleShare = 0.25;

/// Ways of the tip shorter than that are none (m): feed then is that of the rotation.
inline constexpr double kStandingTip = 1e-9;

/// Rotary joints at a fraction of a move.
struct RotaryKnot {
  double fraction = 0.0;
  Joints Q = Joints::Zero();  // rad; linear joints unused
  // On the way from the knot before the joints of the great circle change evenly. They do not where
  // it passes a singular direction within the tolerance.
  bool is_even = true;
};

/// The rotary joints while the tool axis turns on a great circle.
struct AxisTurn {
  /// Joints that go linearly between them keep to the tolerance; the first is behind the begin, the
  /// last at the end.
  std::vector<RotaryKnot> knots;
  double angle = 0.0;  // rad, of the tool axis
  std::string fault;   // why the joints cannot do it; empty: they can
};

class ToolCentrePoint {
 public:
  /// @param lower, upper    travel (5; m, rad); that of the linear joints does not limit the tip
  /// @param axis_tolerance  rad, by which the tool axis may leave its great circle
  ToolCentrePoint(const plant::MachineChain& chain, const Joints& lower, const Joints& upper,
                  double axis_tolerance);

  const plant::MachineChain& chain() const { return inverse_.chain(); }
  const plant::InverseKinematics& inverse() const { return inverse_; }
  double axis_tolerance() const { return axis_tolerance_; }
  int number_of_rotary_axes() const { return number_of_rotary_; }
  /// Upper ends of travel, also of the linear joints; infinite where the machine names none.
  const Joints& upper_travel() const { return upper_travel_; }

  /// @param machine  positions of the axes (6; m, rad)
  AxisWords tip_words(const AxisWords& machine, const Eigen::Vector3d& p_ST) const;
  /// Its inverse; nullopt if the linear axes cannot bring the tip there.
  std::optional<AxisWords> machine_words(const AxisWords& tip, const Eigen::Vector3d& p_ST) const;
  /// Joints for a tip p_WT (3; m) while the rotary joints stand as in Q_rotary.
  std::optional<Joints> joints(const Eigen::Vector3d& p_WT, const Joints& Q_rotary,
                               const Eigen::Vector3d& p_ST) const;
  /// k_W; depends on the rotary joints alone.
  Eigen::Vector3d tool_axis(const Joints& Q) const;

  /// From the tool axis that the machine has at Q to k_end on the great circle between them,
  /// without a jump of a joint. Near a singular direction the joints turn much for a small angle of
  /// the tool axis; where the great circle passes within the tolerance of such a direction, it is
  /// crossed with the joints that need not turn. From a singular direction it takes the nearest of
  /// the branches (plant/kinematics/branches.h) that get to the end within the travel.
  ///
  ///     k(t) = k_0 cos(t theta) + n sin(t theta),  n in the plane of k_0 and k_end           (1)
  ///
  /// Law: on every chord between knots |k_joints(t) - k(t)| <= axis_tolerance, at equal t.
  /// @param k_end  unit vector
  AxisTurn great_circle(const Joints& Q, const Eigen::Vector3d& k_end) const;

  /// Tool axis on the great circle from k_begin to k_end at t in [0, 1].
  static Eigen::Vector3d axis_between(const Eigen::Vector3d& k_begin, const Eigen::Vector3d& k_end,
                                      double t);

  /// Rotary joints nearest to Q_near that give the tool axis k; the reason if there are none.
  struct Pointing {
    Joints Q;  // linear joints as in Q_near
    std::string fault;
  };
  Pointing point(const Eigen::Vector3d& k, const Joints& Q_near) const;

 private:
  bool keeps_circle(const RotaryKnot& from, RotaryKnot& to, const Eigen::Vector3d& k_begin,
                    const Eigen::Vector3d& k_end) const;
  AxisTurn trace(const RotaryKnot& start, const Eigen::Vector3d& k_begin,
                 const Eigen::Vector3d& k_end) const;
  std::optional<RotaryKnot> depart(const RotaryKnot& start, double t, const Joints& Q,
                                   const Eigen::Vector3d& k_begin,
                                   const Eigen::Vector3d& k_end) const;
  ToolPose anywhere(const Eigen::Vector3d& k, const Joints& Q) const;
  std::string jump_fault(const Joints& from, const Joints& to, const Eigen::Vector3d& k) const;

  plant::InverseKinematics inverse_;
  double axis_tolerance_;
  Joints upper_travel_;
  int number_of_rotary_ = 0;
};

}  // namespace servomill::controllers

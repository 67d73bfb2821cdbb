/// Inverse kinematics of the ideal machine: all joints that put the tool where it is asked to be.
///
/// The tool axis k depends on the rotary axes alone. With e_1 (nearer to the workpiece) and e_2 the
/// directions about which they turn and z the tool axis at zero,
///
///     k = Rot(e_1, q_1) Rot(e_2, q_2) z
///
/// Let v = Rot(e_2, q_2) z = Rot(e_1, -q_1) k. On the sphere e_1, e_2 and v are a triangle with all
/// sides known, whatever the inclination of the axes:
///
///     e_2 ------ phi ------ e_1       theta_1 = angle(e_1, k)    theta_2 = angle(e_2, z)
///         \  E_2         .            phi     = angle(e_1, e_2)
///       theta_2      theta_1
///            \    .                   tan^2(E_2/2) =      sin(s - theta_2) sin(s - phi)
///              v                                     / (sin(s) sin(s - theta_1)),   2 s = sum
///
/// The triangle and its mirror image are the two solutions; the angles between its sides and z and
/// k are q_1 and q_2. This is the second subproblem of Paden and Kahan with the half-angle formula
/// of spherical trigonometry, which stays exact where the triangle is flat: no iteration is needed
/// for any directions of the axes. The linear joints follow from a linear system.
///
/// If k is parallel to e_1 (or z to e_2) the angle q_1 (q_2) does not matter: a singular
/// direction. It then stays where it is and the other axis comes as close as it can.
#pragma once

#include <array>
#include <limits>

#include "plant/kinematics/chain.h"

namespace servomill::plant {

/// Result for a pose.
enum class Reach : std::uint8_t {
  reached,
  orientation,    // no angles of the rotary axes give that tool axis
  position,       // the machine lacks a linear axis to get there
  parallel_axes,  // at these angles two linear axes are parallel
  travel          // every solution lies beyond the travel of some axis
};

struct InverseSettings {
  Joints lower = Joints::Constant(-std::numeric_limits<double>::infinity());  // m, rad; travel
  Joints upper = Joints::Constant(std::numeric_limits<double>::infinity());
  double singular_angle = 1e-12;        // rad; nearer than that a direction is singular, and the
                                        // tool axis may be missed by as much
  double orientation_tolerance = 1e-9;  // rad; how far the tool axis may lie beyond what the
                                        // machine can reach. The nearest axis is then taken.
  double travel_tolerance = 1e-9;       // m, rad; how far a joint may lie beyond its travel
};

/// Joints for a pose, or why there are none.
struct JointSolution {
  Reach reach = Reach::orientation;
  bool is_singular = false;   // an angle was free, and was kept
  int joint = 0;              // travel: of the joint that is farthest beyond
  double miss = 0.0;          // of what was not reached: rad (orientation), m (position), m or rad
                              // (travel). 0 where it was reached.
  Joints Q = Joints::Zero();  // m, rad; where not reached: as near as rotary axes, then linear, get

  bool is_reached() const { return reach == Reach::reached; }
};

/// All solutions, the nearest first.
struct JointSolutions {
  int count = 0;  // 1 or 2
  std::array<JointSolution, 2> all;

  const JointSolution& nearest() const { return all[0]; }
};

/// The inverse kinematics of a machine with up to two rotary axes, of any directions, anywhere in
/// the chain. Constant after construction: any number of threads may share it. Calls do not
/// allocate.
///
/// Laws, for all poses P that the machine reaches:
///   (1) forward(Q) = P for every solution, within 1e-12 m and 1e-12 unless the settings allow more
///   (2) Q is among the solutions of forward(Q), up to full turns
///   (3) solve(forward(Q), Q).nearest() = Q: a standing tool stands still, singular or not
///   (4) each rotary joint is the one nearest to Q_near, among those that differ by full turns,
///       that lies within its travel
class InverseKinematics {
 public:
  explicit InverseKinematics(const MachineChain& chain, const InverseSettings& settings = {});

  const MachineChain& chain() const { return chain_; }
  const InverseSettings& settings() const { return settings_; }

  /// All joints that put the tool at P. Solutions within the travel come first; among them, the one
  /// whose rotary axes turn least: of the two axes, the longer way counts, then the sum.
  /// @param P       tip (3; m) and unit tool axis (3) in W
  /// @param p_ST    tip in the spindle nose (3; m)
  /// @param Q_near  joints before (5; m, rad): which turn, and which angle where it is free
  /// @pre | |k_W| - 1 | < 1e-9
  JointSolutions solve(const ToolPose& P, const Eigen::Vector3d& p_ST, const Joints& Q_near) const;

  /// The first of them.
  JointSolution nearest(const ToolPose& P, const Eigen::Vector3d& p_ST,
                        const Joints& Q_near) const {
    return solve(P, p_ST, Q_near).nearest();
  }

  /// True if no joint lies farther beyond its travel than the tolerance.
  bool is_within_travel(const Joints& Q) const;

  /// Angle between the tool axis and the nearest singular direction (rad, at most pi/2), where
  /// angles change faster than the tool axis by about its reciprocal. pi/2 with less than two
  /// rotary axes.
  double distance_from_singular(const Eigen::Vector3d& k_W) const;

 private:
  // A rotary axis: unit direction in M at zero, the way its coordinate counts, place in Joints.
  struct Rotary {
    Eigen::Vector3d direction;
    double sign;
    int joint;
  };
  // Angles of the rotary axes, tool sense, up to two possibilities.
  struct Angles {
    int count = 0;
    double q[2][2] = {};  // rad; [solution][axis]
    double miss = 0.0;    // rad
    bool is_singular = false;
  };

  Angles angles(const Eigen::Vector3d& k, const Joints& Q_near) const;
  Angles angles_of_one(const Eigen::Vector3d& k, const Joints& Q_near) const;
  Angles angles_of_two(const Eigen::Vector3d& k, const Joints& Q_near) const;
  double tool_sense(const Rotary& axis, const Joints& Q) const;
  void place_turns(JointSolution& solution, const Joints& Q_near) const;
  void place_linear(JointSolution& solution, const ToolPose& P, const Eigen::Vector3d& p_ST) const;
  Joints beyond_travel(const Joints& Q) const;
  void check_travel(JointSolution& solution) const;

  MachineChain chain_;
  InverseSettings settings_;
  std::array<Rotary, 2> rotary_;  // from the workpiece to the tool
  int number_of_rotary_ = 0;
  double phi_ = 0.0, theta_2_ = 0.0;  // rad, see above
  double zeta_ = 0.0;                 // rad, from e_1 to z about e_2
};

}  // namespace servomill::plant

/// Kinematics with geometric errors, and the volumetric error: where the tool is minus where the
/// ideal machine would have it. Sign convention: `plant/geometry/error_model.h`.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "plant/geometry/error_model.h"
#include "plant/geometry/reversal_memory.h"
#include "plant/kinematics/chain.h"
#include "plant/vocabulary/lanes.h"

namespace servomill::plant {

class VolumetricEvaluation;

/// Deviation of the tool from the ideal machine, in W.
struct VolumetricError {
  Eigen::Vector3d dp_W = Eigen::Vector3d::Zero();  // m, of the tip
  Eigen::Vector3d dk_W = Eigen::Vector3d::Zero();  // of the unit tool axis
};

/// A machine with its errors, prepared so that one evaluation costs only the errors that are not
/// zero. Constant after construction: any number of threads may share it. No allocation after that.
///
/// Laws, for all Q and tools:
///   (1) errors zero:  forward(Q) == plant::forward(chain, Q), bit for bit
///   (2) error(Q) = forward(Q) - plant::forward(chain, Q)
///   (3) |error(Q) - first_order_error(Q)| shrinks with the square of the errors
///   (4) forward(inverse(p)) = p
///   (5) linear_jacobian(chain, Q) joint_offset(Q) = error(Q).dp_W
///   (6) poses(Q...), errors(Q...), joint_offsets(Q...) = forward(Q), error(Q), joint_offset(Q) of
///       each, bit for bit
///   (7) forward(Q, p_ST, directions) is that of a machine with travelling(f, direction) for each
///       error f; without directions it is the mean of both, all of them 0
class VolumetricModel {
 public:
  VolumetricModel(const MachineChain& chain, const ErrorModel& errors);

  const MachineChain& chain() const { return chain_; }

  /// Pose of the tool of the machine with errors.
  /// @param Q     joint coordinates (5; m, rad)
  /// @param p_ST  tip in the spindle nose (3; m)
  ToolPose forward(const Joints& Q, const Eigen::Vector3d& p_ST) const;

  /// Exact volumetric error.
  VolumetricError error(const Joints& Q, const Eigen::Vector3d& p_ST) const;

  /// Volumetric error to first order in the errors: the sum of the screws that the single errors
  /// would cause on an otherwise ideal machine.
  VolumetricError first_order_error(const Joints& Q, const Eigen::Vector3d& p_ST) const;

  /// Shift of X, Y, Z (3; m) that moves the ideal tip by error(Q).dp_W. Where the linear axes
  /// cannot do that (fewer than three, or two of them parallel at these angles) the shift that
  /// comes closest, and the smallest of those; 0 for axes that the machine lacks.
  Eigen::Vector3d joint_offset(const Joints& Q, const Eigen::Vector3d& p_ST) const;

  /// The same of many poses at once, several times faster than one by one.
  /// @param Q    joint coordinates of each pose
  /// @param out  result of each pose, as many
  void poses(std::span<const Joints> Q, const Eigen::Vector3d& p_ST, std::span<ToolPose> out) const;
  void errors(std::span<const Joints> Q, const Eigen::Vector3d& p_ST,
              std::span<VolumetricError> out) const;
  void joint_offsets(std::span<const Joints> Q, const Eigen::Vector3d& p_ST,
                     std::span<Eigen::Vector3d> out) const;

  /// joint_offsets of eight poses in lanes, as simulations of eight runs hold them. All eight are
  /// computed: the joints in lanes that are not used must be numbers.
  /// @param Q    joint coordinates (5)
  /// @param out  shifts of X, Y, Z (3; m)
  void joint_offsets(const LaneArray (&Q)[kJoints], const Eigen::Vector3d& p_ST,
                     LaneArray (&out)[kLinearJoints]) const;

  /// Plays that errors with hysteresis have to remember (ReversalMemory); empty on most machines,
  /// which pay nothing for it.
  const std::vector<Play>& plays() const;

  /// The same where axes have travelled: directions of each of plays(), -1 to 1.
  ToolPose forward(const Joints& Q, const Eigen::Vector3d& p_ST,
                   std::span<const double> directions) const;
  VolumetricError error(const Joints& Q, const Eigen::Vector3d& p_ST,
                        std::span<const double> directions) const;
  VolumetricError first_order_error(const Joints& Q, const Eigen::Vector3d& p_ST,
                                    std::span<const double> directions) const;
  /// @param directions  of each pose, one pose behind the other
  void poses(std::span<const Joints> Q, const Eigen::Vector3d& p_ST,
             std::span<const double> directions, std::span<ToolPose> out) const;

  /// Derivatives of forward() with respect to all joints, error functions included.
  PoseJacobian jacobian(const Joints& Q, const Eigen::Vector3d& p_ST) const;

  /// Linear joints that put the true tip at p_WT, rotary joints as in Q_near, by Newton's method.
  /// @return all joints (5; m, rad), or nullopt if the tip is not within kInverseTolerance after
  ///         kMaxNewtonSteps, or two linear axes are parallel
  std::optional<Joints> inverse(const Eigen::Vector3d& p_WT, const Joints& Q_near,
                                const Eigen::Vector3d& p_ST) const;

  static constexpr double kInverseTolerance = 1e-12;  // m
  static constexpr int kMaxNewtonSteps = 20;

 private:
  // EX. EY. EZ. 0 EA. EB. EC. 0: two halves, so that neither straddles a vector register.
  using Screw = Eigen::Matrix<double, 8, 1>;

  // Errors of one axis, laid out for evaluation with derivatives: all six polynomials are one of
  // vectors.
  struct Prepared {
    struct PreparedHarmonic {
      int lane;
      double amplitude, omega, phase;  // m or rad, 1/m or 1, rad
      bool same_wave;                  // as the harmonic before: its sine is taken again
    };
    struct PreparedTable {
      int lane;
      LinearTable table;
    };

    std::vector<Screw> polynomial;  // c0, c1, ...
    std::vector<PreparedHarmonic> harmonics;
    std::vector<PreparedTable> tables;
    struct PreparedReversal {
      int lane;
      std::size_t play;
      Reversal reversal;
    };
    std::vector<PreparedReversal> reversals;
    struct PreparedGrid {
      int lane;
      std::vector<int> joints;  // of the arguments
      GridFunction function;
    };
    std::vector<PreparedGrid> grids;
    int joint = 0;            // of the axis
    std::vector<int> joints;  // of the axis and of the arguments of its grids, each once
    Screw location = Screw::Zero();
    Eigen::Matrix3d R_location = Eigen::Matrix3d::Identity();  // of L
  };

  // joint_offset by the longer ways.
  void find_offset(const Joints& Q, const Eigen::Vector3d& p_ST, Eigen::Vector3d& d) const;

  static Eigen::Vector3d shift_of(const Screw& e) { return e.head<3>(); }
  static Eigen::Vector3d turn_of(const Screw& e) { return e.segment<3>(4); }
  Prepared prepare(const ChainAxis& axis, const ErrorModel& errors) const;
  static Screw values(const Prepared& errors, const Joints& Q);
  static Screw reversals(const Prepared& errors, double q, std::span<const double> directions);
  template <class Values>
  VolumetricError first_order(const Joints& Q, const Eigen::Vector3d& p_ST, Values values) const;
  // With respect to one joint.
  static Screw derivatives(const Prepared& errors, const Joints& Q, int joint);
  static Screw derivatives_of_axis(const Prepared& errors, double q);

  MachineChain chain_;
  std::vector<Prepared> errors_;     // in the order of chain_.axes
  bool linear_axes_are_orthogonal_;  // three of them, no rotary axis between
  std::shared_ptr<const VolumetricEvaluation> evaluation_;
};

/// The same for one evaluation; prepare a VolumetricModel for many.
ToolPose forward(const MachineChain& chain, const ErrorModel& errors, const Joints& Q,
                 const Eigen::Vector3d& p_ST);
VolumetricError volumetric_error(const MachineChain& chain, const ErrorModel& errors,
                                 const Joints& Q, const Eigen::Vector3d& p_ST);
VolumetricError first_order_volumetric_error(const MachineChain& chain, const ErrorModel& errors,
                                             const Joints& Q, const Eigen::Vector3d& p_ST);
std::optional<Joints> nonideal_inverse(const MachineChain& chain, const ErrorModel& errors,
                                       const Eigen::Vector3d& p_WT, const Joints& Q_near,
                                       const Eigen::Vector3d& p_ST);
Eigen::Vector3d joint_offset(const MachineChain& chain, const ErrorModel& errors, const Joints& Q,
                             const Eigen::Vector3d& p_ST);

}  // namespace servomill::plant

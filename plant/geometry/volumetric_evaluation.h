/// A machine and its errors written down for the kernels, and the calls of them: the inside of
/// VolumetricModel.
#pragma once

#include <span>
#include <vector>

#include "plant/geometry/error_model.h"
#include "plant/geometry/linear_axis_kernel.h"
#include "plant/geometry/prepared_functions.h"
#include "plant/geometry/reversal_memory.h"
#include "plant/geometry/volumetric_kernel.h"
#include "plant/kinematics/chain.h"

namespace servomill::plant {

/// Constant after construction. Numbers behind `out`: 6 of a tool (tip, axis), 6 of an error (of
/// the tip, of the axis), 3 of an offset (X, Y, Z; only where three linear axes are orthogonal),
/// for each pose.
class VolumetricEvaluation {
 public:
  VolumetricEvaluation(const MachineChain& chain, const ErrorModel& errors,
                       SimdLevel level = simd_level());
  VolumetricEvaluation(const VolumetricEvaluation&) = delete;
  VolumetricEvaluation& operator=(const VolumetricEvaluation&) = delete;

  void tool(const Joints& Q, const Eigen::Vector3d& p_ST, double* out) const {
    one(kernel_.tool, Q, p_ST, out);
  }
  void error(const Joints& Q, const Eigen::Vector3d& p_ST, double* out) const {
    one(kernel_.error, Q, p_ST, out);
  }
  void offset(const Joints& Q, const Eigen::Vector3d& p_ST, double* out) const;

  /// Plays of the reversals; where directions are not given, the mean of both is meant.
  const std::vector<Play>& plays() const { return functions_.plays(); }
  void tool(const Joints& Q, const Eigen::Vector3d& p_ST, std::span<const double> directions,
            double* out) const {
    one_with_reversals(kernel_.tool, Q, p_ST, directions, out);
  }
  void error(const Joints& Q, const Eigen::Vector3d& p_ST, std::span<const double> directions,
             double* out) const {
    one_with_reversals(kernel_.error, Q, p_ST, directions, out);
  }

  void tools(std::span<const Joints> Q, const Eigen::Vector3d& p_ST, double* out) const;
  void errors(std::span<const Joints> Q, const Eigen::Vector3d& p_ST, double* out) const;
  void offsets(std::span<const Joints> Q, const Eigen::Vector3d& p_ST, double* out) const;
  void offsets(const LaneArray (&Q)[kJoints], const Eigen::Vector3d& p_ST,
               LaneArray (&out)[kLinearJoints]) const;

  /// Offsets go the linear-axis path (linear_axis_kernel.h).
  bool has_linear_axes_only() const { return has_linear_axes_only_; }
  /// They do, and nothing is to be found before.
  bool is_plain() const { return is_plain_; }
  /// The offset then.
  void plain_offset(const Joints& Q, const Eigen::Vector3d& p_ST, double* out) const {
    linear_axis_kernel_.one(linear_axis_, nullptr, p_ST.data(), Q.data(), out);
  }

 private:
  void add(const ChainAxis& axis, const ErrorModel& errors);
  void find_ends();
  void find_linear_axis_path(const MachineChain& chain, const ErrorModel& errors);
  void add_linear_axis(std::size_t n, const VolumetricStep& step, const MachineChain& chain,
                       const ErrorModel& errors);
  void lay_out_linear_axis_powers();

  void one(VolumetricKernel::One call, const Joints& Q, const Eigen::Vector3d& p_ST,
           double* out) const {
    if (functions_.has_tables()) {
      one_with_tables(call, Q, p_ST, out);
    } else {
      call(program_, nullptr, Q.data(), p_ST.data(), out);
    }
  }
  void one_with_tables(VolumetricKernel::One call, const Joints& Q, const Eigen::Vector3d& p_ST,
                       double* out) const;
  void one_with_reversals(VolumetricKernel::One call, const Joints& Q, const Eigen::Vector3d& p_ST,
                          std::span<const double> directions, double* out) const;
  void many(VolumetricKernel::Many call, std::size_t numbers, std::span<const Joints> Q,
            const Eigen::Vector3d& p_ST, double* out) const;
  void eight_with_tables(VolumetricKernel::Many call, const Joints* Q, const Eigen::Vector3d& p_ST,
                         double* out) const;
  void linear_axis_offsets(std::span<const Joints> Q, const Eigen::Vector3d& p_ST,
                           double* out) const;
  template <class Coordinate>
  Eigen::Vector3d tip_before_linear_axes(const Coordinate& q, const Eigen::Vector3d& p_ST) const;
  template <class Coordinate>
  LinearAxisData data_of_eight(const Coordinate& q, const Eigen::Vector3d& p_ST) const;

  VolumetricKernel kernel_;
  VolumetricProgram program_{};
  std::vector<VolumetricStep> steps_;
  PreparedFunctions functions_;    // axes counted as joints
  std::vector<ChainAxis> rotary_;  // in the order of the steps

  bool has_linear_axes_only_ = false, is_plain_ = false;
  LinearAxisKernel linear_axis_kernel_{};
  LinearAxisProgram linear_axis_{};
  PreparedFunctions linear_axis_functions_;  // axes counted as the tool passes them
  std::vector<LinearAxisPower> linear_axis_powers_;
  std::size_t tip_turns_ = 0;  // rotary axes among the steps that offsets need
};

}  // namespace servomill::plant

/// A machine and its errors written down for the kernels, and the calls of them: the inside of
/// VolumetricModel.
#pragma once

#include <span>
#include <vector>

#include "plant/geometry/error_model.h"
#include "plant/geometry/volumetric_kernel.h"
#include "plant/kinematics/chain.h"

namespace servomill::plant {

/// Linear between points as LinearTable, with the same values, found in a time that does not depend
/// on the number of points unless they are very unevenly spaced.
class TableLookup {
 public:
  explicit TableLookup(const LinearTable& table);
  double value(double at) const;

 private:
  struct Interval {
    double s, error, slope;
  };
  std::vector<Interval> intervals_;  // [i]: from point i
  double first_, last_, last_error_;
  double buckets_per_s_;
  std::vector<std::uint32_t> interval_of_bucket_;  // in which the bucket begins
};

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
    one(kernel_.tool, rotary_.size(), Q, p_ST, out);
  }
  void error(const Joints& Q, const Eigen::Vector3d& p_ST, double* out) const {
    one(kernel_.error, rotary_.size(), Q, p_ST, out);
  }
  void offset(const Joints& Q, const Eigen::Vector3d& p_ST, double* out) const {
    one(kernel_.offset, offset_rotary_, Q, p_ST, out);
  }
  void tools(std::span<const Joints> Q, const Eigen::Vector3d& p_ST, double* out) const;
  void errors(std::span<const Joints> Q, const Eigen::Vector3d& p_ST, double* out) const;
  void offsets(std::span<const Joints> Q, const Eigen::Vector3d& p_ST, double* out) const;

 private:
  struct Table {
    std::size_t joint, component;
    TableLookup lookup;
  };

  void add_steps_of(const ChainAxis& axis, const ErrorModel& errors);
  void add_functions_of(const ChainAxis& axis, const ErrorModel& errors);
  void add_harmonics();
  void add_coefficient(std::size_t power, std::size_t component, int joint, double value);
  void find_ends();
  void one(VolumetricKernel::One call, std::size_t turned, const Joints& Q,
           const Eigen::Vector3d& p_ST, double* out) const {
    if (turned == 0 && tables_.empty()) {
      call(program_, nullptr, Q.data(), p_ST.data(), out);
    } else {
      one_with_data(call, turned, Q, p_ST, out);
    }
  }
  void one_with_data(VolumetricKernel::One call, std::size_t turned, const Joints& Q,
                     const Eigen::Vector3d& p_ST, double* out) const;
  void many(VolumetricKernel::Many call, std::size_t turned, std::size_t numbers,
            std::span<const Joints> Q, const Eigen::Vector3d& p_ST, double* out) const;
  void eight(VolumetricKernel::Many call, std::size_t turned, const Joints* Q,
             const Eigen::Vector3d& p_ST, double* out) const;

  VolumetricKernel kernel_;
  VolumetricProgram program_{};
  std::vector<VolumetricStep> steps_;
  std::vector<VolumetricPower> powers_;  // c0, c1, ...
  std::vector<VolumetricWaves> waves_;
  struct Wave {
    std::size_t component, joint;
    double amplitude, omega, phase;
  };
  std::vector<Wave> all_waves_;
  std::vector<VolumetricHarmonic> harmonics_;
  std::vector<Table> tables_;
  std::vector<ChainAxis> rotary_;  // in the order of the steps
  std::size_t offset_rotary_ = 0;  // those among the steps that offsets need
};

}  // namespace servomill::plant

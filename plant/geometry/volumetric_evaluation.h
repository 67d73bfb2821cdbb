/// A machine and its errors written down for the kernels, and the calls of them: the inside of
/// VolumetricModel.
#pragma once

#include <span>
#include <vector>

#include "plant/geometry/error_model.h"
#include "plant/geometry/straight_kernel.h"
#include "plant/geometry/travel_memory.h"
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

/// The functions of axes, laid out for kernels.
class PreparedFunctions {
 public:
  /// Adds the function of an error.
  /// @param axis   as the program counts axes
  /// @param joint  its place in Joints
  void add(std::size_t axis, std::size_t component, std::size_t joint, const ErrorFunction& f);
  /// Adds its reversals, which `add` leaves out.
  void add_reversals(std::size_t axis, std::size_t component, std::size_t joint,
                     const ErrorFunction& f);

  /// All that were added. Points into this.
  VolumetricFunctions finish();

  /// Plays of the reversals, each once.
  const std::vector<Play>& plays() const { return plays_; }
  /// add(axis, component, value) for the value of each reversal at q(joint).
  /// @param directions  of each play
  template <class Coordinate, class Add>
  void reversals_at(const Coordinate& q, std::span<const double> directions,
                    const Add& add_value) const {
    for (const HalfReversal& r : reversals_) {
      add_value(r.axis, r.component, directions[r.play] * r.half.value(q(r.joint)));
    }
  }

  bool has_tables() const { return !tables_.empty(); }
  /// add(axis, component, value) for the value of each table at q(joint).
  template <class Coordinate, class Add>
  void tables_at(const Coordinate& q, const Add& add_value) const {
    for (const Table& t : tables_) add_value(t.axis, t.component, t.lookup.value(q(t.joint)));
  }

 private:
  struct Table {
    std::size_t axis, component, joint;
    TableLookup lookup;
  };
  struct HalfReversal {
    std::size_t axis, component, joint, play;
    Reversal half;  // of its width
  };
  struct Wave {
    std::size_t axis, component;
    double amplitude, omega, phase;
  };

  void add_coefficient(std::size_t power, std::size_t component, std::size_t axis, double value);
  void join_waves();

  std::vector<VolumetricPower> powers_;  // c0, c1, ...
  std::vector<Wave> all_waves_;
  std::vector<VolumetricWaves> waves_;
  std::vector<VolumetricHarmonic> harmonics_;
  std::vector<Table> tables_;
  std::vector<HalfReversal> reversals_;
  std::vector<Play> plays_;
  VolumetricFunctions functions_{};
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
    one(kernel_.tool, Q, p_ST, out);
  }
  void error(const Joints& Q, const Eigen::Vector3d& p_ST, double* out) const {
    one(kernel_.error, Q, p_ST, out);
  }
  void offset(const Joints& Q, const Eigen::Vector3d& p_ST, double* out) const;

  /// Plays that reversals need; without directions the mean of both is meant.
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

  /// Offsets go the straight way (straight_kernel.h).
  bool is_straight() const { return is_straight_; }
  /// They do, and nothing is to be found before.
  bool is_plain() const { return is_plain_; }
  /// The offset then.
  void plain_offset(const Joints& Q, const Eigen::Vector3d& p_ST, double* out) const {
    straight_kernel_.one(straight_, nullptr, p_ST.data(), Q.data(), out);
  }

 private:
  void add_steps_of(const ChainAxis& axis, const ErrorModel& errors);
  void add_inclined_steps_of(const ChainAxis& axis, const ErrorModel& errors);
  void find_ends();
  void find_straight_way(const MachineChain& chain, const ErrorModel& errors);
  void add_straight_axis(std::size_t n, const VolumetricStep& step, const MachineChain& chain,
                         const ErrorModel& errors);
  void lay_out_straight_powers();

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
  void straight_offsets(std::span<const Joints> Q, const Eigen::Vector3d& p_ST, double* out) const;
  template <class Coordinate>
  Eigen::Vector3d tip_before_linear_axes(const Coordinate& q, const Eigen::Vector3d& p_ST) const;
  template <class Coordinate>
  StraightData data_of_eight(const Coordinate& q, const Eigen::Vector3d& p_ST) const;

  VolumetricKernel kernel_;
  VolumetricProgram program_{};
  std::vector<VolumetricStep> steps_;
  PreparedFunctions functions_;    // axes counted as joints
  std::vector<ChainAxis> rotary_;  // in the order of the steps

  bool is_straight_ = false, is_plain_ = false;
  StraightKernel straight_kernel_{};
  StraightProgram straight_{};
  PreparedFunctions straight_functions_;  // axes counted as the tool passes them
  std::vector<StraightPower> straight_powers_;
  std::size_t tip_turns_ = 0;  // rotary axes among the steps that offsets need
};

}  // namespace servomill::plant

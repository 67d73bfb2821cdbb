/// Deflection of the structure between scales and tool tip by the acceleration of the axes: cross
/// talk, which no scale measures.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "plant/structure/mode_step.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/ticks.h"

namespace servomill::plant {

/// Displacement of the tip along one linear axis by the acceleration of one joint. With k > 0 the
/// tip lags behind:
///   e_i = -k_ij(Q) G_ij(s) a_j,   k_ij(Q) = gain + gain_slope Q[along],   G_ij = 1 or that of a
///   mode
/// Source: Heidenhain, Technical Manual iTNC 530 HSCI (2013), pp. 688-689 (cross talk compensation:
/// static, k linear in one position).
struct InertialCompliance {
  int direction = 0;        // 0 to 2: X, Y, Z; towards + of the joint
  int joint = 0;            // that accelerates
  double gain = 0.0;        // m per m/s^2 (m per rad/s^2 of a rotary joint)
  double gain_slope = 0.0;  // the same per m
  int along = 0;            // linear joint on whose position k depends
  Mode mode = {};           // w = 0: static

  bool operator==(const InertialCompliance&) const = default;
  bool is_static() const { return mode.w == 0.0; }
  double gain_at(const Joints& Q) const { return gain + gain_slope * Q[along]; }
};

/// All deflections of one machine in one run. Advanced from instant to instant of the drives.
class InertialDeflection {
 public:
  /// @param pairs        each pair of direction and joint at most once
  /// @param base_period  s
  /// @param steps        step lengths that `advance` will be asked for, in ticks
  InertialDeflection(const std::vector<InertialCompliance>& pairs, double base_period,
                     const std::vector<Tick>& steps);

  /// At rest at Q (5; m, rad).
  void start(const Joints& Q);
  /// The joints have moved to Q with the velocity dQ (5; m/s, rad/s). Neither allocates nor throws.
  /// @pre step is one of those given at construction
  void advance(const Joints& Q, const Joints& dQ, Tick step);

  /// True if some pair is static: only then ddQ matters.
  bool needs_acceleration() const { return !static_.empty(); }
  /// Deflection in each linear axis (3; m) where the last step has ended.
  /// @param ddQ  acceleration of the joints there (5; m/s^2, rad/s^2)
  Eigen::Vector3d at(const Joints& ddQ) const;

 private:
  struct Resonance {
    InertialCompliance pair;
    ModeState state;
  };

  double base_period_;
  std::vector<InertialCompliance> static_;
  std::vector<Resonance> modes_;
  std::vector<int> first_of_step_;  // in steps_; -1: not prepared
  std::vector<ModeStep> steps_;     // step length after step length, mode after mode
  Joints Q_ = Joints::Zero(), dQ_ = Joints::Zero();
};

}  // namespace servomill::plant

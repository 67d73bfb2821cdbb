/// Deflection of the structure between scales and tool tip by the acceleration of the axes: cross
/// talk, which no scale measures.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plant/structure/inertial_compliance.h"
#include "plant/structure/mode_step.h"
#include "plant/vocabulary/axes.h"
#include "plant/vocabulary/ticks.h"

namespace servomill::plant {

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

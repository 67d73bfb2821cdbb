/// Vibration of the tool point in steps of constant force.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plant/structure/inertial_compliance.h"
#include "plant/structure/mode_step.h"

namespace servomill::plant {

/// All modes of a tool point in one run, from rest; static ones are left out. A step is exact for a
/// force that is constant over it.
class ToolPointVibration {
 public:
  /// Displacement of the tool point along the linear axes (m) and its velocity (m/s).
  struct State {
    Eigen::Vector3d x = Eigen::Vector3d::Zero(), dx = Eigen::Vector3d::Zero();
  };

  /// @param step  s
  ToolPointVibration(const std::vector<StructuralMode>& modes, double step);

  /// State at the begin of a step.
  State now() const;
  /// State at its end under a force (3; N, along the linear axes).
  State after(const Eigen::Vector3d& force) const;
  /// Ends the step.
  void advance(const Eigen::Vector3d& force);

  /// Cubic between the ends of a step, at a share of it.
  static Eigen::Vector3d between(const State& a, const State& b, double step, double share);

 private:
  struct Oscillator {
    Eigen::Vector3d direction;
    double compliance;                // m/N
    ModeStep free;                    // motion without a force over a step
    ModeState now;                    // eta: displacement (m) along the direction
    ModeState after(double f) const;  // f: N, along the direction
  };
  std::vector<Oscillator> modes_;
};

}  // namespace servomill::plant

/// Vibration of the tool point in steps of constant force.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plant/structure/inertial_compliance.h"

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
    double q_q, q_dq, dq_q, dq_dq;  // free motion over a step
    double q_f, dq_f;               // m/N, m/(N s), of a force along the direction
    double q = 0.0, dq = 0.0;       // m, m/s

    double next_q(double f) const { return q_q * q + q_dq * dq + q_f * f; }
    double next_dq(double f) const { return dq_q * q + dq_dq * dq + dq_f * f; }
  };
  std::vector<Oscillator> modes_;
};

}  // namespace servomill::plant

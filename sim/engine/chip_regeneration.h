/// Regeneration of chips in a run: the tool point vibrates, and each tooth meets the surface that
/// the displacements of the tooth passages before have left.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plant/cutting/vibrating_teeth.h"
#include "plant/structure/tool_point_vibration.h"

namespace servomill::sim::engine {

/// Displacements x(t) - x(t - m T) of the tool point against those m tooth passages ago (3; m, in
/// W).
using DisplacementsBefore = std::array<Eigen::Vector3d, plant::kPassagesBefore>;

/// Modes of the tool point and the course of their displacement, in equal steps. The force of a
/// step depends on the displacement in its middle, which depends on the force: a fixed point, that
/// a few iterations reach (second order in the step).
class ChipRegeneration {
 public:
  /// @param step     s, of the teeth
  /// @param longest  s, largest time from tooth to tooth
  ChipRegeneration(const std::vector<plant::StructuralMode>& modes, double step, double longest);

  /// Bytes of the course that one of these holds.
  static double memory(double step, double longest);

  /// A step with its force on the tool (3; N, in W). Neither allocates nor throws.
  /// @param J_pL      displacement of the tip in W by that along the linear axes (3 x 3)
  /// @param passage   T, s
  /// @param force_of  const DisplacementsBefore& -> force (3; N, in W)
  template <class ForceOf>
  Eigen::Vector3d step(const Eigen::Matrix3d& J_pL, double passage, ForceOf force_of) {
    begin(J_pL);
    Eigen::Vector3d force = force_;
    for (int n = 0; n < kIterations; ++n) {
      force = force_of(displacements(vibration_.after(J_pL.transpose() * force), J_pL, passage));
    }
    end(force);
    return force;
  }
  /// A step without a cut.
  void rest(const Eigen::Matrix3d& J_pL) {
    begin(J_pL);
    end(Eigen::Vector3d::Zero());
  }

  /// Displacement of the tool point along the linear axes (3; m) a time (s) after the last step has
  /// begun.
  Eigen::Vector3d deflection(double after) const;

 private:
  static constexpr int kIterations = 4;

  void begin(const Eigen::Matrix3d& J_pL);
  void end(const Eigen::Vector3d& force);
  DisplacementsBefore displacements(const plant::ToolPointVibration::State& next,
                                    const Eigen::Matrix3d& J_pL, double passage) const;
  Eigen::Vector3d past(double steps) const;

  plant::ToolPointVibration vibration_;
  double step_;
  std::vector<plant::ToolPointVibration::State> course_;  // ring, in W; zero before the start
  std::size_t newest_ = 0;
  Eigen::Matrix3d J_pL_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  plant::ToolPointVibration::State begin_, end_;  // of the last step, along the linear axes
};

}  // namespace servomill::sim::engine

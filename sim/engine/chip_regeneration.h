/// Regeneration of chips in a run: the tool point vibrates or gives way, and each tooth meets the
/// surface that the displacements of the tooth passages before have left.
///
/// Without modes that vibrate, the displacement is that of the force at the same instant,
///
///     x(t) = C F(x(t) - x(t - T), ...)                                                       (1)
///
/// an equation for x in each step. Where a tooth adds the force -K (x(t) - x(t - T)) against a
/// displacement across the wall and the structure resists with k, what is left of the final
/// deflection shrinks by (K/k) / (1 + K/k) from tooth to tooth.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "plant/cutting/vibrating_teeth.h"
#include "plant/structure/tool_point_vibration.h"
#include "sim/engine/force_balance.h"

namespace servomill::sim::engine {

/// Displacements x(t) - x(t - m T) of the tool point against those m tooth passages ago (3; m, in
/// W).
using DisplacementsBefore = std::array<Eigen::Vector3d, plant::kPassagesBefore>;

/// Modes of the tool point and the course of their displacement, in equal steps. The force of a
/// step depends on the displacement in its middle, which depends on the force: of modes a fixed
/// point that a few iterations reach (second order in the step), of a static compliance (1).
class ChipRegeneration {
 public:
  /// @param step     s, of the teeth
  /// @param longest  s, largest time from tooth to tooth
  /// @param held     C, of the tool point along the linear axes without delay (3 x 3; m/N)
  ChipRegeneration(const std::vector<plant::StructuralMode>& modes, double step, double longest,
                   const Eigen::Matrix3d& held = Eigen::Matrix3d::Zero());

  /// Bytes of the course that one of these holds.
  static double memory(double step, double longest);

  /// A step with its force on the tool (3; N, in W). Neither allocates nor throws.
  /// @param J_pL      displacement of the tip in W by that along the linear axes (3 x 3)
  /// @param passage   T, s
  /// @param force_of  const DisplacementsBefore& -> force (3; N, in W)
  template <class ForceOf>
  Eigen::Vector3d step(const Eigen::Matrix3d& J_pL, double passage, ForceOf force_of) {
    begin(J_pL);
    const auto of = [&](const Eigen::Vector3d& F) -> Eigen::Vector3d {
      return force_of(displacements(F, J_pL, passage));
    };
    Eigen::Vector3d force = force_;
    if (gives_way_) {
      const ForceBalance balance = balanced_force(force, std::ref(of));
      force = balance.force;
      digs_in_ |= !balance.exists;
    } else {
      for (int n = 0; n < kIterations; ++n) force = of(force);
    }
    end(force);
    return force;
  }
  /// A step without a cut.
  void rest(const Eigen::Matrix3d& J_pL) {
    begin(J_pL);
    end(Eigen::Vector3d::Zero());
  }

  /// Vibration of the tool point along the linear axes (3; m), what it gives way left out, a time
  /// (s) after the last step has begun.
  Eigen::Vector3d deflection(double after) const;
  /// True once a force has found no balance with the static compliance.
  bool digs_in() const { return digs_in_; }

 private:
  static constexpr int kIterations = 4;

  void begin(const Eigen::Matrix3d& J_pL);
  void end(const Eigen::Vector3d& force);
  DisplacementsBefore displacements(const Eigen::Vector3d& force, const Eigen::Matrix3d& J_pL,
                                    double passage) const;
  Eigen::Vector3d past(double steps) const;
  Eigen::Vector3d past_held(double steps) const;

  plant::ToolPointVibration vibration_;
  double step_;
  Eigen::Matrix3d held_, held_W_ = Eigen::Matrix3d::Zero();  // along the linear axes; in W
  bool gives_way_, digs_in_ = false;
  std::vector<plant::ToolPointVibration::State> course_;  // ring, in W; zero before the start
  std::vector<Eigen::Vector3d> course_held_;  // likewise, in the middle of steps; of a compliance
  std::size_t newest_ = 0;
  Eigen::Matrix3d J_pL_ = Eigen::Matrix3d::Identity();
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
  plant::ToolPointVibration::State begin_, end_;  // of the last step, along the linear axes
};

}  // namespace servomill::sim::engine

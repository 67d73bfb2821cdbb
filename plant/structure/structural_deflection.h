/// Deflection of the tool tip by a force that acts on it, mode by mode.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plant/structure/inertial_compliance.h"
#include "plant/structure/mode_step.h"

namespace servomill::plant {

/// Modes of one machine in one run, under forces that are held from one instant to the next: exact.
class StructuralDeflection {
 public:
  StructuralDeflection() = default;
  explicit StructuralDeflection(const std::vector<StructuralMode>& modes);

  bool is_rigid() const { return compliance_.isZero(0.0) && modes_.empty(); }
  /// True if it has modes that are not static.
  bool vibrates() const { return !modes_.empty(); }
  /// Compliance of the static modes (m/N).
  const Eigen::Matrix3d& static_compliance() const { return compliance_; }

  /// Goes on by dt (s, >= 0) under the force that has been held, then holds F (3; N). Neither
  /// allocates nor throws.
  void advance(double dt, const Eigen::Vector3d& F);
  /// Deflection in each linear axis (3; m) a time dt (s, >= 0) after the last advance.
  Eigen::Vector3d after(double dt) const;
  /// That of the modes that are not static where the last advance has ended.
  Eigen::Vector3d of_modes() const;

 private:
  struct Resonance {
    StructuralMode mode;
    double away = 0.0;     // m, from where the force holds it
    double speed = 0.0;    // m/s
    double balance = 0.0;  // m, where the force holds it
    double h = 0.0;        // s, length of the step
    ModeStep step{};
  };

  Eigen::Matrix3d compliance_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();  // N
  std::vector<Resonance> modes_;
};

/// Static compliance (m/N) of the tool point: that of the static modes and, in addition, of each
/// linear axis (3; m/N).
Eigen::Matrix3d static_compliance(const std::vector<StructuralMode>& modes,
                                  const Eigen::Vector3d& of_axes);

}  // namespace servomill::plant

/// Mode of the structure, spindle and tool as the tool point shows it under a force on it.
#pragma once

#include <Eigen/Core>

#include "plant/structure/inertial_compliance.h"

namespace servomill::plant {

/// Receptance of the tool point: with q the displacement along d,
///   q'' + 2 zeta w q' + w^2 q = w^2 / k  d . F          q / (d . F) = G(s) / k
/// Several modes add up.
struct ToolPointMode {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // d, unit, along the linear axes
  double stiffness = 0.0;                                // k, N/m
  Mode mode;                                             // w > 0

  bool operator==(const ToolPointMode&) const = default;
};

}  // namespace servomill::plant

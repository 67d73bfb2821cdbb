/// Stability lobes of a tool on a machine, from the modes of its tool point.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "plant/cutting/stability_lobes.h"
#include "plant/structure/inertial_compliance.h"

namespace servomill::sim::frequency {

/// Modes as a cut sees them that feeds along e1, with e2 = k x e1: the part of their direction
/// across the axis k counts. Modes along the axis are left out.
/// @param e1  unit, along the linear axes of the machine
/// @param e2  likewise
std::vector<plant::ChatterMode> modes_across(std::span<const plant::StructuralMode> modes,
                                             const Eigen::Vector3d& e1, const Eigen::Vector3d& e2);

struct LobesRequest {
  plant::FlankEngagement cut;
  std::vector<plant::ChatterMode> modes;  // at least one
  double from = 0.0, to = 0.0;            // 1/s, speeds of the spindle, from > 0
  int points = 2;                         // speeds, equal steps
  double deepest = 0.0;                   // m, up to which limits are searched
};

struct LobesPoint {
  double turns = 0.0;                  // 1/s, of the spindle
  plant::StabilityLimit limit;         // by semi-discretisation
  plant::StabilityLimit zeroth_order;  // closed form with the mean directional factors
};

/// @param threads  at least 1; the result does not depend on it
std::vector<LobesPoint> stability_lobes(const LobesRequest& request, unsigned threads);

}  // namespace servomill::sim::frequency

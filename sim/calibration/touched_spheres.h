/// Spheres that a touch probe has met in single touches.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "plant/kinematics/chain.h"
#include "sim/readings/readings.h"

namespace servomill::sim::calibration {

/// Nominal places of the spheres of a group, and outward normals at the touches.
struct TouchedSpheres {
  std::vector<Eigen::Vector3d> centre;  // m, in W, of each sphere: mean over its poses
  std::vector<Eigen::Vector3d> n_W;     // of each row, from the sphere to the stylus
};

/// Normals follow from a sphere through the touches at the same angles of rotary axes, so that they
/// are right to the noise over the radius wherever the machine's errors have put the stylus.
/// @throws InputError with the row, where there are fewer than three touches at these angles
TouchedSpheres touched_spheres(const readings::Group& group, const plant::MachineChain& chain);

}  // namespace servomill::sim::calibration

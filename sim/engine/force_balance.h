/// Balance of a cutting force that depends on the deflection under itself.
#pragma once

#include <Eigen/Core>
#include <functional>

namespace servomill::sim::engine {

/// A force F = f(F) (3; N).
struct ForceBalance {
  Eigen::Vector3d force;
  bool exists = false;  // else the cut draws the tool in faster than the structure resists: with
                        // det(I - df/dF) <= 0 a force that grows finds no balance again
};

/// Solves F = f(F) by Newton's method. f is linear between kinks, where teeth leave the cut or meet
/// the surface of another tooth: on one side of them a step is exact. Steps that bring F no nearer
/// to f(F) are halved. Does not allocate.
/// @param guess  from which it starts
/// @param f      about 12 evaluations, more at kinks
ForceBalance balanced_force(const Eigen::Vector3d& guess,
                            const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& f);

}  // namespace servomill::sim::engine

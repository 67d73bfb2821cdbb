#include "sim/engine/force_balance.h"

#include <Eigen/LU>

namespace servomill::sim::engine {
namespace {

// Newton converges in a few steps where the cut is stable; halvings (down to 1/4096 of a step)
// carry it over the kink where a tooth leaves the material.
constexpr int kMaxSteps = 30, kMaxHalvings = 12;
constexpr double kBalanced = 1e-9;    // of the force, and N
constexpr double kDifference = 1e-3;  // N, of derivatives

}  // namespace

ForceBalance balanced_force(const Eigen::Vector3d& guess,
                            const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& f) {
  Eigen::Vector3d F = guess, at = f(F);
  for (int step = 0; step < kMaxSteps; ++step) {
    const Eigen::Vector3d residual = at - F;
    if (residual.norm() <= kBalanced * (1.0 + at.norm())) return {at, true};
    Eigen::Matrix3d M = Eigen::Matrix3d::Identity();
    for (int i = 0; i < 3; ++i) {
      M.col(i) -= (f(F + kDifference * Eigen::Vector3d::Unit(i)) - at) / kDifference;
    }
    // Static instability: the force grows faster with the displacement than the stiffness holds
    // against it, and no balance is reached from here.
    if (!(M.determinant() > 0.0)) return {at, false};
    const Eigen::Vector3d direction = M.inverse() * residual;
    double share = 1.0;
    Eigen::Vector3d next = F + direction, next_at = f(next);
    for (int n = 0; n < kMaxHalvings && (next_at - next).norm() >= residual.norm(); ++n) {
      share *= 0.5;
      next = F + share * direction;
      next_at = f(next);
    }
    F = next;
    at = next_at;
  }
  return {at, true};  // at a kink, between the two sides of it
}

}  // namespace servomill::sim::engine

#include "sim/engine/depth_of_cut.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace servomill::sim::engine {
namespace {

constexpr int kIterations = 4;  // until no displacement changes its side

// G: derivative of the force by the displacement, on the side where the cutter is.
Eigen::Matrix3d slope(const std::array<ForcesNearby, 2>& places, const Eigen::Vector3d& d) {
  Eigen::Matrix3d G = Eigen::Matrix3d::Zero();
  for (const ForcesNearby& place : places) {
    if (place.cut == nullptr) continue;
    for (std::size_t i = 0; i < 2; ++i) {
      const Eigen::Vector3d& across = place.cut->across[i];
      const bool is_negative = d.dot(across) < 0.0;
      const Eigen::Vector3d change = place.displaced[2 * i + is_negative] - place.nominal;
      G += (is_negative ? -1.0 : 1.0) * place.share / DisplacedCut::kStep * change *
           across.transpose();
    }
  }
  return G;
}

// Part of a displacement across the feed (m).
double across(const std::array<ForcesNearby, 2>& places, const Eigen::Vector3d& d) {
  double largest = 0.0;
  for (const ForcesNearby& place : places) {
    if (place.cut == nullptr) continue;
    largest =
        std::max(largest, std::hypot(d.dot(place.cut->across[0]), d.dot(place.cut->across[1])));
  }
  return largest;
}

}  // namespace

ForceAtDepth force_at_actual_depth(const std::array<ForcesNearby, 2>& places,
                                   const Eigen::Vector3d& deviation, const Eigen::Matrix3d& C) {
  Eigen::Vector3d nominal = Eigen::Vector3d::Zero();
  for (const ForcesNearby& place : places) nominal += place.share * place.nominal;
  if (nominal.isZero(0.0)) return {};
  const double size = across(places, deviation);
  const Eigen::Vector3d d =
      deviation * std::min(1.0, DisplacedCut::kLargest / std::max(size, 1e-12));
  ForceAtDepth out{.force = nominal};
  for (int n = 0; n < kIterations; ++n) {
    const Eigen::Matrix3d G = slope(places, d + C * out.force);
    const Eigen::Matrix3d balance = Eigen::Matrix3d::Identity() - G * C;
    out.digs_in = balance.determinant() <= 0.0;
    out.force = balance.inverse() * (nominal + G * d);
  }
  if (out.digs_in || out.force.dot(nominal) <= 0.0) {
    out.force.setZero();
  } else {
    out.off_path = across(places, deviation + C * out.force);
  }
  return out;
}

}  // namespace servomill::sim::engine

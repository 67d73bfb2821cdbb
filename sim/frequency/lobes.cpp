#include "sim/frequency/lobes.h"

#include <algorithm>

#include "plant/vocabulary/progress.h"
#include "sim/system/worker_thread.h"

namespace servomill::sim::frequency {

std::vector<plant::ChatterMode> modes_across(std::span<const plant::StructuralMode> modes,
                                             const Eigen::Vector3d& e1, const Eigen::Vector3d& e2) {
  constexpr double kAlong = 1e-6;  // share across the axis of a mode along it
  std::vector<plant::ChatterMode> out;
  for (const plant::StructuralMode& mode : modes) {
    const Eigen::Vector2d across(mode.direction.dot(e1), mode.direction.dot(e2));
    const double share = across.norm();
    if (share < kAlong || mode.is_static()) continue;
    // q is displaced by share q, and driven by the share of the force
    out.push_back({.stiffness = 1.0 / (mode.compliance * share * share),
                   .frequency = mode.mode.w,
                   .damping = mode.mode.zeta,
                   .direction = across / share});
  }
  return out;
}

std::vector<LobesPoint> stability_lobes(const LobesRequest& request, unsigned threads) {
  std::vector<LobesPoint> out(static_cast<std::size_t>(request.points));
  for (std::size_t i = 0; i < out.size(); ++i) {
    const double share = static_cast<double>(i) / std::max(1, request.points - 1);
    out[i].turns = request.from + share * (request.to - request.from);
  }
  Stage stage("speeds", static_cast<double>(out.size()));
  system::for_each_index(out.size(), threads, [&](std::size_t i) {
    LobesPoint& point = out[i];
    point.zeroth_order = plant::zeroth_order_limit(request.cut, request.modes, point.turns);
    point.limit =
        plant::limit_of_stability(request.cut, request.modes, point.turns, request.deepest);
    stage.advance();
  });
  return out;
}

}  // namespace servomill::sim::frequency

#include "sim/evaluation/part_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/evaluation/probed_part.h"
#include "sim/metrology/cmm.h"

namespace servomill::sim {
namespace {

using Eigen::Vector3d;

// Where a point was met; components are NaN where nothing was.
std::vector<Vector3d> measured_points(const ProbedFeature& feature) {
  std::vector<Vector3d> out;
  const std::vector<double> d = mean_of(feature.measured);
  for (std::size_t i = 0; i < d.size(); ++i) {
    const plant::ProbeTarget& target = feature.feature.targets[i];
    out.emplace_back(target.point + d[i] * target.normal);
  }
  return out;
}

}  // namespace

std::variant<PartFit, NoFit> fit_part(std::span<const ProbedFeature> features,
                                      const TriangleMesh& nominal) {
  PartFit out;
  std::vector<std::vector<Vector3d>> measured;
  std::vector<Vector3d> met;
  for (const ProbedFeature& feature : features) {
    measured.push_back(measured_points(feature));
    std::copy_if(measured.back().begin(), measured.back().end(), std::back_inserter(met),
                 [](const Vector3d& p) { return p.allFinite(); });
    for (const plant::ProbeTarget& target : feature.feature.targets) {
      out.off = std::max(out.off, std::abs(nominal.closest(target.point).distance));
    }
  }
  auto fit = best_fit(met, nominal);
  if (NoFit* none = std::get_if<NoFit>(&fit)) return std::move(*none);
  out.fit = std::get<BestFit>(std::move(fit));
  const Vector3d nothing = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  for (const std::vector<Vector3d>& points : measured) {
    std::vector<Arrow>& arrows = out.arrows.emplace_back();
    for (const Vector3d& p : points) {
      arrows.push_back(p.allFinite() ? quiver({&p, 1}, out.fit.motion, nominal).front()
                                     : Arrow{nothing, nothing});
    }
  }
  return out;
}

}  // namespace servomill::sim

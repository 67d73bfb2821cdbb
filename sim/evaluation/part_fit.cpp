#include "sim/evaluation/part_fit.h"

#include <algorithm>
#include <limits>

#include "sim/evaluation/probed_part.h"
#include "sim/metrology/triangle_mesh.h"

namespace servomill::sim::evaluation {
namespace {

using Eigen::Vector3d;

// Measured points; components are NaN where the probe met nothing.
std::vector<Vector3d> measured_points(const ProbedFeature& feature) {
  std::vector<Vector3d> out;
  const std::vector<double> d = mean_deviations(feature);
  for (std::size_t i = 0; i < d.size(); ++i) {
    out.push_back(probed_point(feature.feature.targets[i], d[i]));
  }
  return out;
}

}  // namespace

std::variant<PartFit, metrology::NoFit> fit_part(std::span<const ProbedFeature> features,
                                                 const metrology::TriangleMesh& nominal) {
  PartFit out;
  std::vector<std::vector<Vector3d>> measured;
  std::vector<Vector3d> met;
  for (const ProbedFeature& feature : features) {
    measured.push_back(measured_points(feature));
    std::copy_if(measured.back().begin(), measured.back().end(), std::back_inserter(met),
                 [](const Vector3d& p) { return p.allFinite(); });
  }
  auto fit = metrology::best_fit(met, nominal);
  if (metrology::NoFit* none = std::get_if<metrology::NoFit>(&fit)) return std::move(*none);
  out.fit = std::get<metrology::BestFit>(std::move(fit));
  const Vector3d nothing = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  for (const std::vector<Vector3d>& points : measured) {
    std::vector<metrology::Arrow>& arrows = out.arrows.emplace_back();
    for (const Vector3d& p : points) {
      arrows.push_back(p.allFinite() ? metrology::quiver({&p, 1}, out.fit.motion, nominal).front()
                                     : metrology::Arrow{nothing, nothing});
    }
  }
  return out;
}

}  // namespace servomill::sim::evaluation

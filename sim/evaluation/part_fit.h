/// A probed part aligned with the nominal one by best fit.
#pragma once

#include <span>
#include <string>
#include <variant>
#include <vector>

#include "sim/metrology/best_fit.h"

namespace servomill::sim::metrology {
class TriangleMesh;
}  // namespace servomill::sim::metrology

namespace servomill::sim::evaluation {

struct ProbedFeature;

/// Best fit of all probed points of a case.
struct PartFit {
  metrology::BestFit fit;  // of all points that were met, feature by feature
  std::vector<std::vector<metrology::Arrow>> arrows;  // feature, point; NaN: nothing was met
};

/// Lays the means of the repetitions on a mesh in the frame of the nominal points.
std::variant<PartFit, metrology::NoFit> fit_part(std::span<const ProbedFeature> features,
                                                 const metrology::TriangleMesh& nominal);

}  // namespace servomill::sim::evaluation

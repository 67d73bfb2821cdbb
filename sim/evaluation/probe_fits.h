/// Points of a probed feature, and the geometry that is fitted to them.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "sim/evaluation/probed_part.h"

namespace servomill::sim::model {
struct QuantitySpec;
}  // namespace servomill::sim::model

namespace servomill::sim::evaluation {

struct CaseData;

/// The points of a feature that were met.
struct Points {
  const ProbedFeature* feature = nullptr;  // nullptr: not probed
  std::vector<std::size_t> index;          // among all of the feature
  std::vector<double> d;                   // m, along the normals
  std::vector<Eigen::Vector3d> p;          // m
  std::string note;                        // how many of them were met, unless all
};

/// @param base  the nominal points are then moved by what they differ from the same points of it;
///              nullptr: none
Points points_of(const std::string& name, const CaseData& one, const CaseData* base);

/// A value in SI, or why the points do not tell.
struct Fitted {
  std::optional<double> value;
  std::string why_not = {};
};

Fitted straightness(const model::QuantitySpec& spec, const Points& points);
Fitted flatness(const model::QuantitySpec& spec, const Points& points);
Fitted plane_rotation(const model::QuantitySpec& spec, const Points& points);
Fitted roundness(const model::QuantitySpec& spec, const Points& points);
Fitted cylindricity(const model::QuantitySpec& spec, const Points& points);
Fitted diameter(const model::QuantitySpec& spec, const Points& points);
/// Along spec.axis, minus nominal.
Fitted position(const model::QuantitySpec& spec, const Points& points);
/// Minus nominal.
Fitted angle_between_features(const Points& one, const Points& other, bool must_be_square);

}  // namespace servomill::sim::evaluation

/// Probing plan of a coordinate measuring machine (CMM): features with their nominal points.
///
/// All coordinates are those of the work frame G (sim/model/work_frame.h), in m; normals point out
/// of the part and have length 1.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "plant/cutting/probe_target.h"
#include "plant/vocabulary/input_error.h"

namespace servomill::sim::metrology {

enum class FeatureKind : std::uint8_t { line, plane, circle, cylinder, notch, points };

/// "line", "plane", ...
std::string_view name_of(FeatureKind kind);

/// A feature of the part. What its kind does not need is left as it is.
struct Feature {
  FeatureKind kind = FeatureKind::points;
  std::vector<plant::ProbeTarget> targets;
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();      // line, notch: begin; plane: corner;
                                                         // circle, cylinder: centre
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  // line, notch: unit, to the end
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();     // line, plane: unit, out of the part
  double radius = 0.0;                                   // circle, cylinder: m
  double length = 0.0;                                   // line, notch, cylinder: m
};

/// A feature as a scenario asks for it.
struct ProbeSpec {
  std::string name;
  Feature feature;
  Place place;  // of its name
};

/// Points at equal distances from one end to the other, both among them, on a face that faces
/// `normal`.
/// @pre from != to; normal unit and across the line; points >= 2
Feature line_feature(const Eigen::Vector3d& from, const Eigen::Vector3d& to,
                     const Eigen::Vector3d& normal, int points);

/// A grid on the parallelogram corner + a u + b v, 0 <= a, b <= 1, u running first.
/// @pre u, v not parallel; normal unit and across both; at least two points each way
Feature plane_feature(const Eigen::Vector3d& corner, const Eigen::Vector3d& u,
                      const Eigen::Vector3d& v, const Eigen::Vector3d& normal, int points_u,
                      int points_v);

/// An arc about Z from X towards Y; of a whole turn the end is left out.
struct ArcOfPoints {
  double from = 0.0, to = 0.0;  // rad, to > from
  int points = 0;
};

/// A circle about Z.
/// @param outside  the wall of a boss, else that of a bore
/// @pre radius > 0
Feature circle_feature(const Eigen::Vector3d& centre, double radius, bool outside,
                       const ArcOfPoints& arc);

/// Circles one above the other, from the centre to the height `to_z`, the first one first.
/// @pre radius > 0; rings >= 2; to_z differs from the centre's z
Feature cylinder_feature(const Eigen::Vector3d& centre, double radius, bool outside,
                         const ArcOfPoints& arc, double to_z, int rings);

/// The two flanks of a notch of that width: first the left one seen along the centre line with Z
/// up, then the right one. Both normals point into the notch, that is out of the part.
/// @pre from != to, at the same height; width > 0; points >= 1, on each flank
Feature notch_feature(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double width,
                      int points);

}  // namespace servomill::sim::metrology

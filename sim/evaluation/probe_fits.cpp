#include "sim/evaluation/probe_fits.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/tool_axis.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/comparison.h"
#include "sim/metrology/circle_fit.h"
#include "sim/metrology/cylinder_fit.h"
#include "sim/metrology/line_fit.h"
#include "sim/metrology/minimum_zone.h"
#include "sim/metrology/plane_fit.h"
#include "sim/model/scenario.h"

namespace servomill::sim::evaluation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSquare = 1e-3;  // rad: what features at right angles may nominally miss

const ProbedFeature* find(const CaseData* one, const std::string& name) {
  if (one == nullptr || one->probes == nullptr) return nullptr;
  const auto found = std::find_if(one->probes->begin(), one->probes->end(),
                                  [&](const ProbedFeature& f) { return f.name == name; });
  return found == one->probes->end() ? nullptr : &*found;
}

std::string missed_note(const CaseData& one, const Points& points, bool with_base) {
  const std::size_t all = points.feature->deviation.size();
  if (points.d.size() == all) return "";
  const std::string of = fmt::format("{} of {} points of '{}'{}", points.d.size(), all,
                                     points.feature->name, with_base ? " in both cases" : "");
  if (!points.d.empty()) return of;
  return fmt::format(
      "no point of '{}' met a cut surface{}: check that the tool of case {} reaches it",
      points.feature->name, with_base ? " in both cases" : "", one.name);
}

std::vector<Vector2d> seen_from_above(const Points& points) {
  std::vector<Vector2d> out;
  for (const Vector3d& p : points.p) out.emplace_back(p.head<2>());
  return out;
}

// A line in its own plane: along it and along its normal.
std::vector<Vector2d> along_line(const Points& points) {
  const metrology::Feature& line = points.feature->feature;
  std::vector<Vector2d> out;
  for (const Vector3d& p : points.p) {
    out.emplace_back((p - line.origin).dot(line.direction), (p - line.origin).dot(line.normal));
  }
  return out;
}

// True if points around a circle leave no gap of half a turn or more.
bool go_around(const Points& points) {
  const metrology::Feature& round = points.feature->feature;
  std::vector<double> angles;
  for (const Vector3d& p : points.p) {
    const Vector3d d = p - round.origin;
    angles.push_back(std::atan2(d.y(), d.x()));
  }
  std::sort(angles.begin(), angles.end());
  double gap = angles.front() + 2.0 * std::numbers::pi - angles.back();
  for (std::size_t i = 1; i < angles.size(); ++i) gap = std::max(gap, angles[i] - angles[i - 1]);
  return gap < std::numbers::pi;
}

constexpr const char* kTooFew = "too few points";
constexpr double kAcross = 1e-6;  // component of a normal that counts as none
constexpr const char* kGap =
    "minimum zone needs points all around, without a gap of half a turn; use fit = "
    "\"least_squares\"";

template <class Shape>
Fitted width_of(const std::optional<metrology::Zone<Shape>>& zone) {
  if (!zone) return {{}, kTooFew};
  return {zone->width};
}

std::optional<metrology::Cylinder> cylinder_of(const Points& points) {
  return metrology::least_squares_cylinder(points.p, Vector3d::UnitZ());
}

// Mean of the displacements, each along its normal; of a notch that of its centre line.
double mean_position(const Points& points, int axis) {
  const auto& targets = points.feature->feature.targets;
  if (points.feature->feature.kind != metrology::FeatureKind::notch) {
    double sum = 0.0;
    for (std::size_t i = 0; i < points.d.size(); ++i) {
      sum += points.d[i] * targets[points.index[i]].normal[axis];
    }
    return sum / static_cast<double>(points.d.size());
  }
  // the flanks weigh the same, whatever each of them missed
  std::array<double, 2> sum = {0.0, 0.0}, count = {0.0, 0.0};
  for (std::size_t i = 0; i < points.d.size(); ++i) {
    const std::size_t flank = points.index[i] < targets.size() / 2 ? 0 : 1;
    sum[flank] += points.d[i] * targets[points.index[i]].normal[axis];
    count[flank] += 1.0;
  }
  return 0.5 * (sum[0] / count[0] + sum[1] / count[1]);
}

// Direction of a feature, nominal and measured.
struct Direction {
  Vector3d nominal, actual;
};

std::optional<Direction> direction_of(const Points& points) {
  const metrology::Feature& nominal = points.feature->feature;
  if (nominal.kind == metrology::FeatureKind::plane) {
    const auto plane = metrology::least_squares_plane(points.p, nominal.normal);
    if (!plane) return std::nullopt;
    return Direction{nominal.normal, plane->normal};
  }
  const std::vector<Vector2d> p = along_line(points);
  const auto line = metrology::least_squares_line(metrology::Points2(p));
  if (!line) return std::nullopt;
  return Direction{nominal.direction,
                   line->direction[0] * nominal.direction + line->direction[1] * nominal.normal};
}

}  // namespace

Points points_of(const std::string& name, const CaseData& one, const CaseData* base) {
  Points out;
  const ProbedFeature* mine = find(&one, name);
  const ProbedFeature* other = find(base, name);
  if (mine == nullptr || (base != nullptr && other == nullptr)) return out;
  out.feature = mine;
  const std::vector<double> d = mean_deviations(*mine, other);
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (std::isnan(d[i])) continue;
    out.index.push_back(i);
    out.d.push_back(d[i]);
    out.p.push_back(probed_point(mine->feature.targets[i], d[i]));
  }
  out.note = missed_note(one, out, base != nullptr);
  return out;
}

Fitted straightness(const model::QuantitySpec& spec, const Points& points) {
  const bool minimum = spec.part->minimum_zone;
  const std::vector<Vector2d> p = along_line(points);
  if (minimum) return width_of(metrology::minimum_zone_line(p));
  const auto line = metrology::least_squares_line(p);
  if (!line) return {{}, kTooFew};
  return {metrology::spread_about(metrology::Points2(p), *line).range()};
}

Fitted flatness(const model::QuantitySpec& spec, const Points& points) {
  const bool minimum = spec.part->minimum_zone;
  const Vector3d& outside = points.feature->feature.normal;
  if (minimum) return width_of(metrology::minimum_zone_plane(points.p, outside));
  const auto plane = metrology::least_squares_plane(points.p, outside);
  if (!plane) return {{}, kTooFew};
  return {metrology::spread_about(metrology::Points3(points.p), *plane).range()};
}

Fitted plane_rotation(const model::QuantitySpec& spec, const Points& points) {
  const Vector3d& normal = points.feature->feature.normal;
  const auto plane = metrology::least_squares_plane(points.p, normal);
  if (!plane) return {{}, kTooFew};
  return {metrology::rotation_between(normal, plane->normal)[spec.axis - 'X']};
}

Fitted roundness(const model::QuantitySpec& spec, const Points& points) {
  const bool minimum = spec.part->minimum_zone;
  if (points.p.size() < 3) return {{}, kTooFew};
  const std::vector<Vector2d> p = seen_from_above(points);
  if (!minimum)
    return {metrology::zone_about(p, metrology::least_squares_circle(p).centre).width()};
  if (!go_around(points)) return {{}, kGap};
  return {metrology::minimum_zone(p).width()};
}

Fitted cylindricity(const model::QuantitySpec& spec, const Points& points) {
  const bool minimum = spec.part->minimum_zone;
  if (minimum && !go_around(points)) return {{}, kGap};
  if (minimum) return width_of(metrology::minimum_zone_cylinder(points.p, Vector3d::UnitZ()));
  const auto cylinder = cylinder_of(points);
  if (!cylinder) return {{}, kTooFew};
  return {metrology::spread_about(metrology::Points3(points.p), *cylinder).range()};
}

Fitted diameter(const model::QuantitySpec&, const Points& points) {
  const metrology::Feature& nominal = points.feature->feature;
  if (nominal.kind == metrology::FeatureKind::cylinder) {
    const auto cylinder = cylinder_of(points);
    if (!cylinder) return {{}, kTooFew};
    return {2.0 * (cylinder->radius - nominal.radius)};
  }
  if (points.p.size() < 3) return {{}, kTooFew};
  return {2.0 * (metrology::least_squares_circle(seen_from_above(points)).radius - nominal.radius)};
}

Fitted position(const model::QuantitySpec& spec, const Points& points) {
  const char letter = spec.axis;
  const int axis = letter - 'X';
  const metrology::Feature& nominal = points.feature->feature;
  if (nominal.kind == metrology::FeatureKind::circle && axis < 2) {
    if (points.p.size() < 3) return {{}, kTooFew};
    return {metrology::least_squares_circle(seen_from_above(points)).centre[axis] -
            nominal.origin[axis]};
  }
  if (nominal.kind == metrology::FeatureKind::cylinder && axis < 2) {
    const auto cylinder = cylinder_of(points);
    if (!cylinder) return {{}, kTooFew};
    const Vector3d& k = cylinder->direction;
    const double up = (nominal.origin - cylinder->point).dot(k);
    return {(cylinder->point + up * k - nominal.origin)[axis]};
  }
  const auto& targets = nominal.targets;
  if (std::all_of(targets.begin(), targets.end(), [axis](const plant::ProbeTarget& target) {
        return std::abs(target.normal[axis]) < kAcross;
      })) {
    return {{}, fmt::format("none of its normals has a component along {}", letter)};
  }
  const double mean = mean_position(points, axis);
  if (std::isnan(mean)) return {{}, "needs points on both flanks"};
  return {mean};
}

Fitted angle_between_features(const Points& one, const Points& other, bool must_be_square) {
  const auto a = direction_of(one), b = direction_of(other);
  if (!a || !b) return {{}, kTooFew};
  const double nominal = angle_between(a->nominal, b->nominal);
  if (must_be_square && std::abs(nominal - 90 * deg) > kSquare) {
    return {{}, fmt::format("they are nominally at {:.6g} deg; use angle", nominal / deg)};
  }
  return {angle_between(a->actual, b->actual) - nominal};
}

}  // namespace servomill::sim::evaluation

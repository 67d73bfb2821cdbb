#include "sim/evaluation/probe_quantities.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "plant/vocabulary/tool_axis.h"
#include "plant/vocabulary/units.h"
#include "sim/evaluation/probed_part.h"
#include "sim/metrology/best_fit.h"
#include "sim/metrology/circle_fit.h"
#include "sim/metrology/cylinder_fit.h"
#include "sim/metrology/line_fit.h"
#include "sim/metrology/minimum_zone.h"
#include "sim/metrology/plane_fit.h"
#include "sim/model/scenario.h"

namespace servomill::sim {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kSquare = 1e-3;  // rad: what features at right angles may nominally miss

constexpr std::array kAll = {FeatureKind::line,     FeatureKind::plane, FeatureKind::circle,
                             FeatureKind::cylinder, FeatureKind::notch, FeatureKind::points};
constexpr std::array kLine = {FeatureKind::line};
constexpr std::array kPlane = {FeatureKind::plane};
constexpr std::array kCircle = {FeatureKind::circle};
constexpr std::array kCylinder = {FeatureKind::cylinder};
constexpr std::array kRound = {FeatureKind::circle, FeatureKind::cylinder};
constexpr std::array kStraight = {FeatureKind::line, FeatureKind::plane};

const ProbedFeature* find(const CaseData* one, const std::string& name) {
  if (one == nullptr || one->probes == nullptr) return nullptr;
  const auto found = std::find_if(one->probes->begin(), one->probes->end(),
                                  [&](const ProbedFeature& f) { return f.name == name; });
  return found == one->probes->end() ? nullptr : &*found;
}

// The points of a feature that were met.
struct Points {
  const ProbedFeature* feature = nullptr;  // nullptr: not probed
  std::vector<std::size_t> index;          // among all of the feature
  std::vector<double> d;                   // m, along the normals
  std::vector<Vector3d> p;                 // m
  std::string note;
};

std::string missed_note(const CaseData& one, const Points& points, bool with_base) {
  const std::size_t all = points.feature->deviation.size();
  if (points.d.size() == all) return "";
  const std::string of = fmt::format("{} of {} points of '{}'{}", points.d.size(), all,
                                     points.feature->name, with_base ? " in both cases" : "");
  if (!points.d.empty()) return of;
  return fmt::format("no point of '{}' met a cut surface{}: does the tool of case {} come there?",
                     points.feature->name, with_base ? " in both cases" : "", one.name);
}

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

std::vector<Vector2d> seen_from_above(const Points& points) {
  std::vector<Vector2d> out;
  for (const Vector3d& p : points.p) out.emplace_back(p.head<2>());
  return out;
}

// A line in its own plane: along it and along its normal.
std::vector<Vector2d> along_line(const Points& points) {
  const Feature& line = points.feature->feature;
  std::vector<Vector2d> out;
  for (const Vector3d& p : points.p) {
    out.emplace_back((p - line.origin).dot(line.direction), (p - line.origin).dot(line.normal));
  }
  return out;
}

// True if points around a circle leave no gap of half a turn or more.
bool go_around(const Points& points) {
  const Feature& round = points.feature->feature;
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

struct Fitted {
  std::optional<double> value;  // SI
  std::string why_not = {};
};

constexpr const char* kTooFew = "too few points";
constexpr double kAcross = 1e-6;  // component of a normal that counts as none
constexpr const char* kGap =
    "minimum zone needs points all around, no gap of half a turn; fit = \"least_squares\" does not";

template <class Shape>
Fitted width_of(const std::optional<Zone<Shape>>& zone) {
  if (!zone) return {{}, kTooFew};
  return {zone->width};
}

Fitted straightness(const Points& points, bool minimum) {
  const std::vector<Vector2d> p = along_line(points);
  if (minimum) return width_of(minimum_zone_line(p));
  const auto line = least_squares_line(p);
  if (!line) return {{}, kTooFew};
  return {spread_about(Points2(p), *line).range()};
}

Fitted flatness(const Points& points, bool minimum) {
  const Vector3d& outside = points.feature->feature.normal;
  if (minimum) return width_of(minimum_zone_plane(points.p, outside));
  const auto plane = least_squares_plane(points.p, outside);
  if (!plane) return {{}, kTooFew};
  return {spread_about(Points3(points.p), *plane).range()};
}

Fitted plane_rotation(const Points& points, char axis) {
  const Vector3d& normal = points.feature->feature.normal;
  const auto plane = least_squares_plane(points.p, normal);
  if (!plane) return {{}, kTooFew};
  return {rotation_between(normal, plane->normal)[axis - 'X']};
}

Fitted roundness(const Points& points, bool minimum) {
  if (points.p.size() < 3) return {{}, kTooFew};
  const std::vector<Vector2d> p = seen_from_above(points);
  if (!minimum) return {zone_about(p, least_squares_circle(p).centre).width()};
  if (!go_around(points)) return {{}, kGap};
  return {minimum_zone(p).width()};
}

std::optional<Cylinder> cylinder_of(const Points& points) {
  return least_squares_cylinder(points.p, Vector3d::UnitZ());
}

Fitted cylindricity(const Points& points, bool minimum) {
  if (minimum && !go_around(points)) return {{}, kGap};
  if (minimum) return width_of(minimum_zone_cylinder(points.p, Vector3d::UnitZ()));
  const auto cylinder = cylinder_of(points);
  if (!cylinder) return {{}, kTooFew};
  return {spread_about(Points3(points.p), *cylinder).range()};
}

Fitted diameter(const Points& points) {
  const Feature& nominal = points.feature->feature;
  if (nominal.kind == FeatureKind::cylinder) {
    const auto cylinder = cylinder_of(points);
    if (!cylinder) return {{}, kTooFew};
    return {2.0 * (cylinder->radius - nominal.radius)};
  }
  if (points.p.size() < 3) return {{}, kTooFew};
  return {2.0 * (least_squares_circle(seen_from_above(points)).radius - nominal.radius)};
}

// Mean of the displacements, each along its normal; of a notch that of its centre line.
double mean_position(const Points& points, int axis) {
  const auto& targets = points.feature->feature.targets;
  if (points.feature->feature.kind != FeatureKind::notch) {
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

Fitted position(const Points& points, char letter) {
  const int axis = letter - 'X';
  const Feature& nominal = points.feature->feature;
  if (nominal.kind == FeatureKind::circle && axis < 2) {
    if (points.p.size() < 3) return {{}, kTooFew};
    return {least_squares_circle(seen_from_above(points)).centre[axis] - nominal.origin[axis]};
  }
  if (nominal.kind == FeatureKind::cylinder && axis < 2) {
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
    return {{}, fmt::format("no normal of its points has a component along {}", letter)};
  }
  const double mean = mean_position(points, axis);
  if (std::isnan(mean)) return {{}, "needs points on both flanks"};
  return {mean};
}

// Direction of a feature, nominal and measured.
struct Direction {
  Vector3d nominal, actual;
};

std::optional<Direction> direction_of(const Points& points) {
  const Feature& nominal = points.feature->feature;
  if (nominal.kind == FeatureKind::plane) {
    const auto plane = least_squares_plane(points.p, nominal.normal);
    if (!plane) return std::nullopt;
    return Direction{nominal.normal, plane->normal};
  }
  const std::vector<Vector2d> p = along_line(points);
  const auto line = least_squares_line(Points2(p));
  if (!line) return std::nullopt;
  return Direction{nominal.direction,
                   line->direction[0] * nominal.direction + line->direction[1] * nominal.normal};
}

Fitted angle(const Points& one, const Points& other, bool must_be_square) {
  const auto a = direction_of(one), b = direction_of(other);
  if (!a || !b) return {{}, kTooFew};
  const double nominal = angle_between(a->nominal, b->nominal);
  if (must_be_square && std::abs(nominal - 90 * deg) > kSquare) {
    return {{},
            fmt::format("they should be at {:.6g} deg; angle tells the deviation", nominal / deg)};
  }
  return {angle_between(a->actual, b->actual) - nominal};
}

Fitted evaluate(const QuantitySpec& spec, std::span<const Points> points) {
  const Points& one = points.front();
  const bool minimum = spec.part->minimum_zone;
  if (spec.name == "straightness") return straightness(one, minimum);
  if (spec.name == "flatness") return flatness(one, minimum);
  if (spec.name == "plane_rotation") return plane_rotation(one, spec.axis);
  if (spec.name == "roundness") return roundness(one, minimum);
  if (spec.name == "cylindricity") return cylindricity(one, minimum);
  if (spec.name == "diameter") return diameter(one);
  if (spec.name == "probed_position") return position(one, spec.axis);
  assert(spec.name == "angle" || spec.name == "squareness");
  return angle(one, points.back(), spec.name == "squareness");
}

constexpr const char* kNotProbed = "was not probed";

// Points of all features from the nominal part, or from the planes through their targets, once they
// are laid upon it.
ProbedDeviations distortion(const QuantitySpec& spec, const CaseData& one, const CaseData* base) {
  std::vector<Vector3d> measured, nominal, normals;
  ProbedDeviations out;
  for (const std::string& name : spec.part->probes) {
    const Points points = points_of(name, one, base);
    if (points.feature == nullptr) return {{}, kNotProbed};
    if (!out.note.empty() && !points.note.empty()) out.note += "; ";
    out.note += points.note;
    for (std::size_t i = 0; i < points.p.size(); ++i) {
      const plant::ProbeTarget& target = points.feature->feature.targets[points.index[i]];
      measured.push_back(points.p[i]);
      nominal.push_back(target.point);
      normals.push_back(target.normal);
    }
  }
  const TriangleMesh* part = spec.part->nominal.get();
  const auto fit = part ? best_fit(measured, *part) : best_fit(measured, nominal, normals);
  if (const NoFit* none = std::get_if<NoFit>(&fit)) return {{}, none->why};
  for (const double distance : std::get<BestFit>(fit).distances) out.d.push_back(distance / um);
  return out;
}

}  // namespace

std::span<const FeatureKind> kinds_of(std::string_view quantity) {
  assert(quantity_info(quantity).probes > 0);
  if (quantity == "straightness") return kLine;
  if (quantity == "flatness" || quantity == "plane_rotation") return kPlane;
  if (quantity == "roundness") return kCircle;
  if (quantity == "cylindricity") return kCylinder;
  if (quantity == "diameter") return kRound;
  if (quantity == "angle" || quantity == "squareness") return kStraight;
  return kAll;
}

ProbedDeviations probed_deviations(const QuantitySpec& spec, const CaseData& one,
                                   const CaseData* base) {
  if (spec.name == "distortion") return distortion(spec, one, base);
  const Points points = points_of(spec.part->probes.front(), one, base);
  if (points.feature == nullptr) return {{}, kNotProbed};
  const bool minus_imposed = spec.name == "probed_imposed_residual";
  ProbedDeviations out{{}, points.note};
  for (std::size_t i = 0; i < points.d.size(); ++i) {
    const double imposed = minus_imposed ? points.feature->imposed.at(points.index[i]) : 0.0;
    out.d.push_back((points.d[i] - imposed) / um);
  }
  return out;
}

ProbedValue probed_value(const QuantitySpec& spec, const CaseData& one, const CaseData* base) {
  std::vector<Points> points;
  std::string note;
  for (const std::string& name : spec.part->probes) {
    points.push_back(points_of(name, one, base));
    if (points.back().feature == nullptr) return {kNone, kNotProbed};
    if (points.back().d.empty()) return {kNone, points.back().note};
    if (!note.empty() && !points.back().note.empty()) note += "; ";
    note += points.back().note;
  }
  const Fitted found = evaluate(spec, points);
  if (!found.value) return {kNone, found.why_not};
  const std::string_view unit = quantity_info(spec.name).unit;
  return {*found.value / (unit == "deg" ? deg : um), note};  // um/m is urad
}

}  // namespace servomill::sim

#include "sim/evaluation/probe_quantities.h"

#include <fmt/format.h>

#include <array>

#include "plant/vocabulary/units.h"
#include "sim/evaluation/case_evaluation.h"
#include "sim/evaluation/probe_fits.h"
#include "sim/evaluation/statistic.h"
#include "sim/metrology/best_fit.h"
#include "sim/metrology/roughness.h"
#include "sim/model/scenario.h"

namespace servomill::sim::evaluation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::array kAll = {metrology::FeatureKind::line,   metrology::FeatureKind::plane,
                             metrology::FeatureKind::circle, metrology::FeatureKind::cylinder,
                             metrology::FeatureKind::notch,  metrology::FeatureKind::points};
constexpr std::array kLine = {metrology::FeatureKind::line};
constexpr std::array kPlane = {metrology::FeatureKind::plane};
constexpr std::array kCircle = {metrology::FeatureKind::circle};
constexpr std::array kCylinder = {metrology::FeatureKind::cylinder};
constexpr std::array kRound = {metrology::FeatureKind::circle, metrology::FeatureKind::cylinder};
constexpr std::array kStraight = {metrology::FeatureKind::line, metrology::FeatureKind::plane};

constexpr const char* kNotProbed = "was not probed";

// Deviations of the points of one feature, as a statistic.
template <bool kMinusImposed>
QuantityValue deviation(const model::QuantitySpec& spec, CaseEvaluation& one,
                        const CaseData* base) {
  const Points points = points_of(spec.part->probes.front(), one.data, base);
  if (points.feature == nullptr) return {.note = kNotProbed};
  Statistic statistic(spec.statistic);
  for (std::size_t i = 0; i < points.d.size(); ++i) {
    const double imposed = kMinusImposed ? points.feature->imposed.at(points.index[i]) : 0.0;
    statistic.add((points.d[i] - imposed) / um);
  }
  return {statistic.value(), points.note};
}

// Points of all features from the nominal part, or from the planes through their targets, once they
// are laid upon it.
QuantityValue distortion(const model::QuantitySpec& spec, CaseEvaluation& compared,
                         const CaseData* base) {
  std::vector<Vector3d> measured, nominal, normals;
  QuantityValue out;
  for (const std::string& name : spec.part->probes) {
    const Points points = points_of(name, compared.data, base);
    if (points.feature == nullptr) return {.note = kNotProbed};
    if (!out.note.empty() && !points.note.empty()) out.note += "; ";
    out.note += points.note;
    for (std::size_t i = 0; i < points.p.size(); ++i) {
      const plant::ProbeTarget& target = points.feature->feature.targets[points.index[i]];
      measured.push_back(points.p[i]);
      nominal.push_back(target.point);
      normals.push_back(target.normal);
    }
  }
  const metrology::TriangleMesh* part = spec.part->nominal.get();
  const auto fit =
      part ? metrology::best_fit(measured, *part) : metrology::best_fit(measured, nominal, normals);
  if (const metrology::NoFit* none = std::get_if<metrology::NoFit>(&fit))
    return {.note = none->why};
  Statistic statistic(spec.statistic);
  for (const double d : std::get<metrology::BestFit>(fit).distances) statistic.add(d / um);
  out.value = statistic.value();
  return out;
}

// The features that a quantity names, or why one of them tells nothing.
struct Named {
  std::vector<Points> points;
  std::string note;
  bool is_complete = false;
};

Named named_points(const model::QuantitySpec& spec, const CaseData& one, const CaseData* base) {
  Named out;
  for (const std::string& name : spec.part->probes) {
    const Points& points = out.points.emplace_back(points_of(name, one, base));
    if (points.feature == nullptr) return {{}, kNotProbed};
    if (points.d.empty()) return {{}, points.note};
    if (!out.note.empty() && !points.note.empty()) out.note += "; ";
    out.note += points.note;
  }
  out.is_complete = true;
  return out;
}

QuantityValue noted(const Fitted& found, double unit, const std::string& note) {
  if (!found.value) return {.note = found.why_not};
  return {*found.value / unit, note};
}

// Fits one feature; um/m is urad.
template <Fitted (*kFit)(const model::QuantitySpec&, const Points&), bool kIsAngle = false>
QuantityValue fitted(const model::QuantitySpec& spec, CaseEvaluation& one, const CaseData* base) {
  const Named named = named_points(spec, one.data, base);
  if (!named.is_complete) return {.note = named.note};
  return noted(kFit(spec, named.points.front()), kIsAngle ? deg : um, named.note);
}

// Ra or Rz of a line; the note states how it was evaluated.
template <double metrology::Roughness::*kParameter>
QuantityValue roughness(const model::QuantitySpec& spec, CaseEvaluation& one,
                        const CaseData* base) {
  const Named named = named_points(spec, one.data, base);
  if (!named.is_complete) return {.note = named.note};
  const Points& points = named.points.front();
  const auto& targets = points.feature->feature.targets;
  if (points.d.size() != targets.size()) return {.note = "needs every point; " + points.note};
  const double length = (targets.back().point - targets.front().point).norm();
  std::string why_not;
  const auto found = metrology::roughness_of(
      points.d, length / (static_cast<double>(targets.size()) - 1.0), why_not);
  if (!found) return {.note = why_not};
  return {*found.*kParameter / um, fmt::format("cut-off {:g} mm, evaluated over {:g} mm",
                                               found->cutoff / mm, found->evaluation_length / mm)};
}

template <bool kMustBeSquare>
QuantityValue angle(const model::QuantitySpec& spec, CaseEvaluation& one, const CaseData* base) {
  const Named named = named_points(spec, one.data, base);
  if (!named.is_complete) return {.note = named.note};
  return noted(angle_between_features(named.points.front(), named.points.back(), kMustBeSquare), um,
               named.note);
}

constexpr QuantityEntry kQuantities[] = {
    {.name = "probed_deviation",
     .unit = "um",
     .help = "probed minus nominal points along their normals; with a baseline minus those of the "
             "baseline",
     .has_statistic = true,
     .probes = 1,
     .kinds = kAll,
     .evaluate = deviation<false>},
    {.name = "probed_imposed_residual",
     .unit = "um",
     .help = "probed points minus those of the baseline minus the imposed displacement, along "
             "their normals",
     .has_statistic = true,
     .needs_baseline = true,
     .needs_imposed = true,
     .probes = 1,
     .kinds = kAll,
     .evaluate = deviation<true>},
    {.name = "probed_position",
     .unit = "um",
     .help = "fitted centre of a probed circle or cylinder, else mean of the points, minus nominal",
     .axes = "XYZ",
     .probes = 1,
     .kinds = kAll,
     .evaluate = fitted<position>},
    {.name = "straightness",
     .unit = "um",
     .help = "smallest distance of two parallel lines that enclose a probed line",
     .probes = 1,
     .kinds = kLine,
     .has_fit = true,
     .evaluate = fitted<straightness>},
    {.name = "roughness_Ra",
     .unit = "um",
     .help = "of a probed line of at least 6 cut-offs (0.08, 0.25, 0.8, 2.5 or 8 mm): arithmetic "
             "mean height over 5 of them (ISO 21920-2, Gaussian filter)",
     .probes = 1,
     .kinds = kLine,
     .evaluate = roughness<&metrology::Roughness::Ra>},
    {.name = "roughness_Rz",
     .unit = "um",
     .help = "of a probed line of at least 6 cut-offs: mean of the peak-to-valley heights of the 5 "
             "sections",
     .probes = 1,
     .kinds = kLine,
     .evaluate = roughness<&metrology::Roughness::Rz>},
    {.name = "flatness",
     .unit = "um",
     .help = "smallest distance of two parallel planes that enclose a probed plane",
     .probes = 1,
     .kinds = kPlane,
     .has_fit = true,
     .evaluate = fitted<flatness>},
    {.name = "plane_rotation",
     .unit = "deg",
     .help = "rotation of the least-squares plane of a probed plane about an axis, from nominal",
     .axes = "XYZ",
     .probes = 1,
     .kinds = kPlane,
     .evaluate = fitted<plane_rotation, true>},
    {.name = "roundness",
     .unit = "um",
     .help = "smallest radial separation of two concentric circles that enclose a probed circle",
     .probes = 1,
     .kinds = kCircle,
     .has_fit = true,
     .evaluate = fitted<roundness>},
    {.name = "cylindricity",
     .unit = "um",
     .help = "smallest radial separation of two coaxial cylinders that enclose a probed cylinder",
     .probes = 1,
     .kinds = kCylinder,
     .has_fit = true,
     .evaluate = fitted<cylindricity>},
    {.name = "diameter",
     .unit = "um",
     .help = "least-squares diameter of a probed circle or cylinder, minus nominal",
     .probes = 1,
     .kinds = kRound,
     .evaluate = fitted<diameter>},
    {.name = "angle",
     .unit = "um/m",
     .help = "angle between two probed lines (from_mm to to_mm) or planes (normals), least "
             "squares, minus nominal",
     .probes = 2,
     .kinds = kStraight,
     .evaluate = angle<false>},
    {.name = "squareness",
     .unit = "um/m",
     .help = "squareness of two probed lines or planes, least squares; positive: more than 90 deg",
     .probes = 2,
     .kinds = kStraight,
     .evaluate = angle<true>},
    {.name = "distortion",
     .unit = "um",
     .help = "distance of the probed points of all features (or of `probes`) from the part "
             "after best fit; without part.stl from the planes through the nominal points",
     .has_statistic = true,
     .probes = kEveryProbe,
     .kinds = kAll,
     .evaluate = distortion},
};

}  // namespace

std::span<const QuantityEntry> probe_quantities() { return kQuantities; }

}  // namespace servomill::sim::evaluation

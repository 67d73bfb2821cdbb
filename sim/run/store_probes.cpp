#include "sim/run/store_probes.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "plant/vocabulary/units.h"
#include "sim/metrology/roughness.h"
#include "sim/records/nexus.h"
#include "sim/records/output_file.h"

namespace servomill::sim::run {
namespace {

std::vector<double> in_um(std::vector<double> values) {
  for (double& value : values) value /= um;
  return values;
}

std::vector<double> from_um(std::vector<double> values) {
  for (double& value : values) value *= um;
  return values;
}

std::vector<double> counted(std::size_t count) {
  std::vector<double> out(count);
  std::iota(out.begin(), out.end(), 0.0);
  return out;
}

void write_fit(records::Hdf5Group& group, std::span<const metrology::Arrow> arrows) {
  std::vector<double> places, deviations;
  for (const metrology::Arrow& arrow : arrows) {
    for (int i = 0; i < 3; ++i) places.push_back(arrow.place[i] / mm);
    for (int i = 0; i < 3; ++i) deviations.push_back(arrow.deviation[i] / um);
  }
  group.table("aligned_position", 3, places,
              {"mm", "point of the nominal part nearest to the probed one after best fit"}, "point",
              "xyz");
  group.table("aligned_deviation", 3, deviations,
              {"um", "probed point minus nominal part after best fit"}, "point", "xyz");
}

void write_motion(records::Hdf5Group& group, const metrology::BestFit& fit) {
  const Eigen::AngleAxisd turn(fit.motion.linear());
  const Eigen::Vector3d shift = fit.motion.translation() / um;
  const Eigen::Vector3d rotation = turn.angle() / urad * turn.axis();
  group.attribute("alignment_shift_um", std::span<const double>(shift.data(), 3));
  group.attribute("alignment_rotation_urad", std::span<const double>(rotation.data(), 3));
  group.attribute("alignment_rms_um", fit.rms / um);
}

void write_frame(records::Hdf5Group& group, const model::PartFrame& frame) {
  const Eigen::Vector3d origin = frame.p_WG / mm;
  const Eigen::Matrix3d by_columns = frame.R_WG.transpose();  // rows of R_WG, one after the other
  group.attribute("work_origin_mm", std::span<const double>(origin.data(), 3));
  group.attribute("work_axes", std::span<const double>(by_columns.data(), 9));
}

// Roughness profile of a line that is long and dense enough for one, and its parameters.
void write_roughness(records::Hdf5Group& group, const evaluation::ProbedFeature& found) {
  const auto& targets = found.feature.targets;
  if (found.feature.kind != metrology::FeatureKind::line || targets.size() < 2) return;
  const std::vector<double> mean = metrology::mean_of(found.measured);
  if (std::any_of(mean.begin(), mean.end(), [](double d) { return std::isnan(d); })) return;
  const double length = (targets.back().point - targets.front().point).norm();
  const double spacing = length / (static_cast<double>(targets.size()) - 1.0);
  std::string why_not;
  const auto roughness = metrology::roughness_of(mean, spacing, why_not);
  if (!roughness) return;
  std::vector<double> x;
  for (std::size_t i = 0; i < roughness->profile.size(); ++i) {
    x.push_back(spacing * static_cast<double>(roughness->first + i) / mm);
  }
  records::Hdf5Group of = group.group("roughness");
  of.attribute("Ra_um", roughness->Ra / um);
  of.attribute("Rz_um", roughness->Rz / um);
  of.attribute("cutoff_mm", roughness->cutoff / mm);
  of.attribute("evaluation_length_mm", roughness->evaluation_length / mm);
  of.list("x", x, {"mm", "from the first point of the line"});
  of.list("height", in_um(roughness->profile),
          {"um", "roughness profile: less the mean line of the Gaussian filter at the cut-off"},
          "x");
  records::make_nexus_data(of, {"height", {"x"}, {}});
}

void write_feature(records::Hdf5Group& group, const evaluation::ProbedFeature& found) {
  group.attribute("kind", metrology::name_of(found.feature.kind));
  group.counts("point", counted(found.deviation.size()), {"1", "number of the point"});
  group.counts("repetition", counted(found.measured.size()), {"1", "number of the repetition"});
  group.labels("xyz", "XYZ", "xyz");
  group.labels("ijk", "IJK", "ijk");
  std::vector<double> nominal, normal, measured;
  for (const plant::ProbeTarget& target : found.feature.targets) {
    for (int i = 0; i < 3; ++i) nominal.push_back(target.point[i] / mm);
    for (int i = 0; i < 3; ++i) normal.push_back(target.normal[i]);
  }
  for (const std::vector<double>& once : found.measured) {
    measured.insert(measured.end(), once.begin(), once.end());
  }
  group.table("nominal", 3, nominal, {"mm", "nominal point in the work frame"}, "point", "xyz");
  group.table("normal", 3, normal, {"1", "normal out of the part in the work frame"}, "point",
              "ijk");
  group.list("deviation", in_um(found.deviation),
             {"um", "surface minus nominal along the normal, without error of the CMM"}, "point");
  group.table("measured", found.deviation.size(), in_um(std::move(measured)),
              {"um", "probed minus nominal along the normal"}, "repetition", "point");
  group.list("sigma", in_um(metrology::standard_deviation_of(found.measured)),
             {"um", "standard deviation of the repetitions"}, "point");
  records::Plot plot{"deviation", {"point"}, {"sigma"}};
  if (!found.imposed.empty()) {
    group.list("imposed", in_um(found.imposed),
               {"um", "displacement along the normal required by the imposed errors"}, "point");
    plot.others.push_back("imposed");
  }
  records::make_nexus_data(group, plot);
  write_roughness(group, found);
}

evaluation::ProbedFeature read_feature(const records::InputFile& file, const std::string& group,
                                       const metrology::ProbeSpec& probe) {
  evaluation::ProbedFeature out{
      probe.name, probe.feature, from_um(file.values(group + "/deviation")), {}, {}};
  const std::size_t points = probe.feature.targets.size();
  const auto shape = file.shape(group + "/measured");
  if (out.deviation.size() != points || shape.size() != 2 || shape[0] == 0 || shape[1] != points) {
    throw InputError({file.path()},
                     fmt::format("'{}' has not the {} points of the scenario", group, points));
  }
  const std::vector<double> all = from_um(file.values(group + "/measured"));
  for (std::size_t r = 0; r < shape[0]; ++r) {
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(r * points);
    out.measured.emplace_back(first, first + static_cast<std::ptrdiff_t>(points));
  }
  if (file.has(group + "/imposed")) out.imposed = from_um(file.values(group + "/imposed"));
  if (!out.imposed.empty() && out.imposed.size() != points) {
    throw InputError({file.path()}, fmt::format("'{}/imposed' has not {} points", group, points));
  }
  return out;
}

}  // namespace

void write_probes(records::Hdf5Group group, std::span<const evaluation::ProbedFeature> features,
                  const model::PartFrame& frame, const std::optional<evaluation::PartFit>& fit) {
  records::make_nexus_group(group, "NXcollection", features.front().name);
  write_frame(group, frame);
  if (fit) write_motion(group, fit->fit);
  for (std::size_t i = 0; i < features.size(); ++i) {
    records::Hdf5Group of_feature = group.group(features[i].name);
    write_feature(of_feature, features[i]);
    if (fit) write_fit(of_feature, fit->arrows[i]);
  }
}

std::vector<evaluation::ProbedFeature> read_probed(const records::InputFile& file,
                                                   const std::string& group,
                                                   std::span<const metrology::ProbeSpec> plan) {
  std::vector<evaluation::ProbedFeature> out;
  if (!file.has(group)) return out;
  for (const metrology::ProbeSpec& probe : plan) {
    out.push_back(read_feature(file, group + "/" + probe.name, probe));
  }
  return out;
}

}  // namespace servomill::sim::run

#include "sim/calibration/sought_grids.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace servomill::sim::calibration {
namespace {

using plant::ErrorName;

constexpr double kSamePlace = 1e-6;                      // m, rad
constexpr std::array<std::size_t, 2> kPlaces = {17, 9};  // that are knots; else equally spaced

// Places of a joint on the lines of an axis, without lines among all readings; ascending.
std::vector<double> places_on_lines(const readings::Readings& readings,
                                    const Observations& observations, Axis of, int joint) {
  std::vector<double> on_lines, all;
  for (const Observation& one : observations.all) {
    for (const Pose& pose : one.poses) {
      all.push_back(pose.Q[joint]);
      if (readings.groups[one.group].axis == of) on_lines.push_back(pose.Q[joint]);
    }
  }
  std::vector<double>& places = on_lines.empty() ? all : on_lines;
  std::sort(places.begin(), places.end());
  std::vector<double> out;
  for (const double place : places) {
    if (out.empty() || place > out.back() + kSamePlace) out.push_back(place);
  }
  return out;
}

std::vector<double> knots_between(const std::vector<double>& places, std::size_t count) {
  std::vector<double> out;
  const double step = (places.back() - places.front()) / static_cast<double>(count - 1);
  for (std::size_t k = 0; k + 1 < count; ++k) {
    out.push_back(places.front() + step * static_cast<double>(k));
  }
  out.push_back(places.back());
  return out;
}

class GridSeeker {
 public:
  GridSeeker(const readings::Readings& readings, const Observations& observations,
             const JointLayout& layout)
      : readings_(readings), observations_(observations), layout_(layout) {}

  SoughtGrid seek(const ErrorName& name, const GridSettings& asked,
                  std::optional<double> size) const {
    GridForm form;
    form.axes = {name.axis, asked.across};
    for (std::size_t k = 0; k < 2; ++k) {
      const int joint = *layout_.joint_of(form.axes[k]);
      form.travel[k] = {readings_.lower[joint], readings_.upper[joint]};
      refuse_endless(name, form.axes[k], form.travel[k]);
      form.knots[k] = knots(name, form.axes[k], joint, asked.knots[k], kPlaces[k]);
      for (double& end : form.travel[k]) {  // of unknown travel
        if (!std::isfinite(end)) end = form.knots[k].front();
      }
    }
    SoughtGrid out{.name = name, .basis = GridBasis(std::move(form))};
    out.size = size.value_or(out.size);
    return out;
  }

 private:
  std::vector<double> knots(const ErrorName& name, Axis axis, int joint, std::optional<int> count,
                            std::size_t most) const {
    const std::vector<double> places = places_on_lines(readings_, observations_, name.axis, joint);
    if (places.size() < 2) {
      refuse(name, fmt::format("the lines of {} are all at one position of {}; two are needed",
                               letter(name.axis), letter(axis)));
    }
    if (count) return knots_between(places, static_cast<std::size_t>(*count));
    return places.size() > most ? knots_between(places, most) : places;
  }

  void refuse_endless(const ErrorName& name, Axis axis, const std::array<double, 2>& travel) const {
    const bool is_known = readings_.lower.array().isFinite().any();
    if (is_linear(axis) || std::isfinite(travel[0]) || !is_known) return;
    refuse(name, fmt::format("{} has no travel limits; grids require axes with travel limits",
                             letter(axis)));
  }

  [[noreturn]] void refuse(const ErrorName& name, const std::string& why) const {
    throw InputError({readings_.path},
                     fmt::format("adjustment.form.{}.grid: {}", plant::to_string(name), why));
  }

  const readings::Readings& readings_;
  const Observations& observations_;
  const JointLayout& layout_;
};

}  // namespace

std::vector<SoughtGrid> sought_grids(const readings::Readings& readings,
                                     const Observations& observations,
                                     const plant::MachineChain& chain,
                                     const CalibrationSettings& settings) {
  const GridSeeker seeker(readings, observations, chain.layout);
  std::vector<SoughtGrid> out;
  for (const auto& [name, form] : settings.forms) {
    for (const GridSettings& asked : form.grids) out.push_back(seeker.seek(name, asked, form.size));
  }
  return out;
}

namespace {

bool is_known(const Adjustment& adjustment, const SoughtGrid& grid) {
  return adjustment.covariance.diagonal().segment(grid.first, grid.basis.size()).sum() > 0.0;
}

bool is_combined_grid(const Adjustment& adjustment, const SoughtGrid& grid) {
  const auto is_of = [&](int unknown) {
    return unknown >= grid.first && unknown < grid.first + grid.basis.size();
  };
  return std::any_of(adjustment.left_out.begin(), adjustment.left_out.end(),
                     [&](const LeftOut& one) {
                       return is_of(one.unknown) ||
                              std::any_of(one.parts.begin(), one.parts.end(),
                                          [&](const auto& part) { return is_of(part.unknown); });
                     });
}

// Effects of all unknowns of the adjustment on an error at s and t of the axes of its grid.
Eigen::RowVectorXd row_at(const Adjustment& adjustment, const SoughtGrid& grid, double s,
                          double t) {
  Eigen::RowVectorXd out = Eigen::RowVectorXd::Zero(adjustment.values.size());
  out.segment(grid.first, grid.basis.size()) = grid.basis.row(s, t);
  for (const SoughtFunction& function : adjustment.unknowns.functions) {
    if (function.name == grid.name) {
      out.segment(function.first, function.basis.size()) = function.basis.row(s, 0.0);
    }
  }
  return out;
}

double sigma_of(const Adjustment& adjustment, const Eigen::RowVectorXd& row) {
  return std::sqrt(std::max(0.0, (row * adjustment.covariance * row.transpose())(0)));
}

}  // namespace

std::vector<KnownGrid> known_grids(const Adjustment& adjustment) {
  std::vector<KnownGrid> out;
  for (const SoughtGrid& grid : adjustment.unknowns.grids) {
    if (!is_known(adjustment, grid)) continue;
    KnownGrid known{.name = grid.name,
                    .form = grid.basis.form(),
                    .is_combined = is_combined_grid(adjustment, grid)};
    for (const double s : known.form.knots[0]) {
      for (const double t : known.form.knots[1]) {
        Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(adjustment.values.size());
        row.segment(grid.first, grid.basis.size()) = grid.basis.row(s, t);
        const double value = row * adjustment.values;
        known.least = std::min(known.least, value);
        known.most = std::max(known.most, value);
        known.sigma = std::max(known.sigma, sigma_of(adjustment, row));
      }
    }
    out.push_back(std::move(known));
  }
  return out;
}

std::vector<KnownLine> lines_of_grids(const Adjustment& adjustment) {
  std::vector<KnownLine> out;
  for (const SoughtGrid& grid : adjustment.unknowns.grids) {
    if (!is_known(adjustment, grid)) continue;
    const GridForm& form = grid.basis.form();
    for (const double t : form.knots[1]) {
      KnownLine line{grid.name, form.axes[1], t, form.knots[0], {}, {}};
      for (const double s : line.s) {
        const Eigen::RowVectorXd row = row_at(adjustment, grid, s, t);
        line.value.push_back(row * adjustment.values);
        line.sigma.push_back(sigma_of(adjustment, row));
      }
      out.push_back(std::move(line));
    }
  }
  return out;
}

}  // namespace servomill::sim::calibration

#include "sim/calibration/heat_regression.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include "plant/geometry/volumetric.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/units.h"
#include "sim/numerics/decompositions.h"
#include "sim/system/json.h"

namespace servomill::sim::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kDependent = 1e-7;  // of the largest eigenvalue, unknowns scaled to equal effect

std::vector<double> pose_of(const HeatReading& one) {
  std::vector<double> out(one.Q.begin(), one.Q.end());
  out.insert(out.end(), one.p_ST.begin(), one.p_ST.end());
  return out;
}

// Unknowns that the readings can hold.
std::vector<HeatTerm> terms_of(const HeatReadings& readings, const JointLayout& layout,
                               const std::vector<plant::ErrorName>& errors) {
  std::vector<HeatTerm> out;
  for (int sensor = 0; sensor < static_cast<int>(readings.sensors.size()); ++sensor) {
    for (const plant::ErrorName& error : errors) {
      out.push_back({sensor, error, false});
      if (error.is_location || !is_linear(error.direction)) continue;  // files have no such slope
      const int j = layout.joint_of(error.axis).value();
      const auto [low, high] = std::minmax_element(
          readings.rows.begin(), readings.rows.end(),
          [&](const HeatReading& a, const HeatReading& b) { return a.Q[j] < b.Q[j]; });
      if (j < kLinearJoints && high->Q[j] - low->Q[j] >= kSlopeSpan) {
        out.push_back({sensor, error, true});
      }
    }
  }
  return out;
}

plant::ErrorModel unit_error(const HeatTerm& term, double size) {
  plant::ErrorModel out;
  if (term.error.is_location) {
    out.location(term.error) = size;
  } else if (term.is_slope) {
    out.component(term.error).polynomial = {0.0, size};
  } else {
    out.component(term.error).polynomial = {size};
  }
  return out;
}

// Effects g of each term along X, Y, Z of the machine at a pose.
std::vector<Vector3d> effects_at(const HeatReading& at, const plant::MachineChain& chain,
                                 const std::vector<HeatTerm>& terms) {
  constexpr double kSize = 1e-6;  // m, rad: small enough to be linear
  const Eigen::Matrix3d J = plant::linear_jacobian(chain, at.Q);
  std::vector<Vector3d> out;
  for (const HeatTerm& term : terms) {
    const plant::VolumetricModel model(chain, unit_error(term, kSize));
    // In axes of the machine, as drift is read there: rotary axes turn the workpiece away from
    // them.
    out.emplace_back(J.transpose() * model.first_order_error(at.Q, at.p_ST).dp_W / kSize);
  }
  return out;
}

// Numbers of drift at one pose in one direction, with their means taken off.
struct Group {
  MatrixXd T;      // K; row a number, column a sensor
  VectorXd drift;  // m
};

// Normal equations, group after group.
class Sums {
 public:
  explicit Sums(const std::vector<HeatTerm>& terms)
      : terms_(terms),
        A_(MatrixXd::Zero(size(), size())),
        b_(VectorXd::Zero(size())),
        squares_(Vector3d::Zero()),
        counts_(Vector3d::Zero()) {}

  void add(const Group& group, const std::vector<Vector3d>& effects, Index direction) {
    MatrixXd rows(group.T.rows(), size());
    for (Index i = 0; i < size(); ++i) {
      const HeatTerm& term = terms_[static_cast<std::size_t>(i)];
      rows.col(i) = group.T.col(term.sensor) * effects[static_cast<std::size_t>(i)][direction];
    }
    A_ += rows.transpose() * rows;
    b_ += rows.transpose() * group.drift;
    squares_[direction] += group.drift.squaredNorm();
    counts_[direction] += static_cast<double>(group.drift.size());
    ++groups_;
    kept_.push_back({std::move(rows), group.drift, direction});
  }

  HeatRegression solve(const HeatReadings& readings) const {
    // Unknowns are um, urad and um/m per kelvin: scaled to equal effect before eigenvalues are
    // compared.
    const VectorXd scale = A_.diagonal().cwiseMax(1e-300).cwiseSqrt();
    refuse_unseen(readings);
    const MatrixXd scaled =
        scale.cwiseInverse().asDiagonal() * A_ * scale.cwiseInverse().asDiagonal();
    const numerics::SymmetricEigen eigen = numerics::symmetric_eigen(scaled);
    refuse_dependent(eigen, readings);
    const MatrixXd inverse = scale.cwiseInverse().asDiagonal() * eigen.vectors *
                             eigen.values.cwiseInverse().asDiagonal() * eigen.vectors.transpose() *
                             scale.cwiseInverse().asDiagonal();
    const VectorXd x = inverse * b_;
    return result(readings, x, inverse);
  }

  // Numbers less unknowns, each group having spent one on its mean.
  double redundancy() const {
    return counts_.sum() - static_cast<double>(groups_) - static_cast<double>(size());
  }

 private:
  struct Kept {
    MatrixXd rows;
    VectorXd drift;
    Index direction;
  };

  Index size() const { return static_cast<Index>(terms_.size()); }

  std::string name(Index i, const HeatReadings& readings) const {
    const HeatTerm& term = terms_[static_cast<std::size_t>(i)];
    return fmt::format("{} of {}{}", to_string(term.error),
                       readings.sensors[static_cast<std::size_t>(term.sensor)],
                       term.is_slope ? " (slope)" : "");
  }

  void refuse_unseen(const HeatReadings& readings) const {
    for (Index i = 0; i < size(); ++i) {
      if (A_(i, i) > 0.0) continue;
      throw InputError({readings.file},
                       fmt::format("does not show {}: its sensor reading does not change, or the "
                                   "error does not affect the measured drift",
                                   name(i, readings)));
    }
  }

  void refuse_dependent(const numerics::SymmetricEigen& eigen, const HeatReadings& readings) const {
    if (eigen.values[0] > kDependent * eigen.values[size() - 1]) return;
    std::vector<std::string> names;
    for (Index i = 0; i < size(); ++i) {
      // Terms with a substantial part (unit vector) in the combination that the readings do not
      // see.
      if (std::abs(eigen.vectors(i, 0)) > 0.3) names.push_back(name(i, readings));
    }
    throw InputError({readings.file},
                     fmt::format("cannot distinguish {}: their temperatures change in proportion; "
                                 "omit one, or measure where they differ",
                                 fmt::join(names, ", ")));
  }

  HeatRegression result(const HeatReadings& readings, const VectorXd& x,
                        const MatrixXd& inverse) const {
    HeatRegression out{readings.sensors, terms_, {}, 0, {}, {}};
    Vector3d left = Vector3d::Zero();
    for (const Kept& one : kept_) {
      left[one.direction] += (one.drift - one.rows * x).squaredNorm();
    }
    out.covariance = inverse * (left.sum() / redundancy());
    for (Index i = 0; i < size(); ++i) {
      HeatTerm& term = out.terms[static_cast<std::size_t>(i)];
      term.value = x[i];
      term.sigma = std::sqrt(out.covariance(i, i));
    }
    out.numbers = static_cast<std::size_t>(counts_.sum());
    const Vector3d counts = counts_.cwiseMax(1.0);
    out.before = squares_.cwiseQuotient(counts).cwiseSqrt();
    out.after = left.cwiseQuotient(counts).cwiseSqrt();
    return out;
  }

  const std::vector<HeatTerm>& terms_;
  MatrixXd A_;
  VectorXd b_;
  Vector3d squares_, counts_;  // of the drift, by direction
  int groups_ = 0;
  std::vector<Kept> kept_;
};

Group group_of(const std::vector<const HeatReading*>& rows, Index direction) {
  std::vector<const HeatReading*> measured;
  for (const HeatReading* row : rows) {
    if (std::isfinite(row->drift[direction])) measured.push_back(row);
  }
  const auto n = static_cast<Index>(measured.size());
  const auto sensors = static_cast<Index>(rows.front()->T.size());
  Group out{MatrixXd(n, sensors), VectorXd(n)};
  for (Index i = 0; i < n; ++i) {
    const HeatReading& row = *measured[static_cast<std::size_t>(i)];
    out.T.row(i) = Eigen::Map<const VectorXd>(row.T.data(), sensors).transpose();
    out.drift[i] = row.drift[direction];
  }
  if (n == 0) return out;
  constexpr double kRounding = 1e-9;  // K
  // Readings of a pose have an unknown zero in each direction: taking the means off both sides is
  // the same as an unknown for each, and keeps the normal equations small.
  out.T.rowwise() -= out.T.colwise().mean().eval();
  for (Index s = 0; s < sensors; ++s) {
    // A sensor that stands still would otherwise explain drift by the rounding of its mean.
    if (out.T.col(s).cwiseAbs().maxCoeff() < kRounding) out.T.col(s).setZero();
  }
  out.drift.array() -= out.drift.mean();
  return out;
}

double unit_of(const HeatTerm& term) { return is_linear(term.error.direction) ? um : urad; }

std::string unit_text(const HeatTerm& term) {
  const std::string unit = is_linear(term.error.direction) ? "um" : "urad";
  return term.is_slope ? unit + "/m" : unit;
}

std::string key_of(const HeatTerm& term, const std::string& sensor) {
  const std::string base =
      fmt::format("heat.sensor.{}.errors_per_K.{}", sensor, to_string(term.error));
  if (term.error.is_location) return base;
  if (term.is_slope) return base + ".um_per_m";
  return fmt::format("{}.constant_{}", base, is_linear(term.error.direction) ? "um" : "urad");
}

}  // namespace

HeatRegression regress(const HeatReadings& readings, const plant::MachineChain& chain,
                       const std::vector<plant::ErrorName>& errors) {
  const std::vector<HeatTerm> terms = terms_of(readings, chain.layout, errors);
  std::map<std::vector<double>, std::vector<const HeatReading*>> poses;
  for (const HeatReading& row : readings.rows) poses[pose_of(row)].push_back(&row);
  Sums sums(terms);
  Stage stage("poses", static_cast<double>(poses.size()));
  for (const auto& [pose, rows] : poses) {
    stage.advance();
    const std::vector<Vector3d> effects = effects_at(*rows.front(), chain, terms);
    for (Index direction = 0; direction < 3; ++direction) {
      const Group group = group_of(rows, direction);
      if (group.drift.size() > 1) sums.add(group, effects, direction);
    }
  }
  if (!(sums.redundancy() > 0.0)) {
    throw InputError({readings.file},
                     fmt::format("has too few readings for {} unknowns", terms.size()));
  }
  return sums.solve(readings);
}

input::IdentifiedFile identified_file(const HeatRegression& found, const HeatReadings& readings,
                                      const std::string& based_on) {
  input::IdentifiedFile out;
  out.comments = {
      "Errors per kelvin of temperature sensors, by servomill identify-heat.",
      fmt::format("{}: {} drift values, {:.3g} um rms, {:.3g} um with these errors compensated",
                  readings.file, found.numbers, found.before.norm() / um, found.after.norm() / um)};
  out.based_on = based_on;
  const auto n = static_cast<Index>(found.terms.size());
  VectorXd units(n);
  for (Index i = 0; i < n; ++i) {
    const HeatTerm& term = found.terms[static_cast<std::size_t>(i)];
    units[i] = unit_of(term);
    out.identified.keys.push_back(
        key_of(term, found.sensors[static_cast<std::size_t>(term.sensor)]));
    // keys of slopes are numbers without a unit
    out.identified.units.push_back(term.is_slope ? std::string(input::kPlainNumber)
                                                 : unit_text(term));
    out.identified.values.push_back(term.value / units[i]);
  }
  const VectorXd per = units.cwiseInverse();
  out.identified.covariance = per.asDiagonal() * found.covariance * per.asDiagonal();
  return out;
}

std::string heat_report(const HeatRegression& found) {
  std::string out =
      fmt::format("{:<12} {:<14} {:>14} {:>16}\n", "sensor", "error", "per kelvin", "+- (k = 2)");
  for (const HeatTerm& term : found.terms) {
    out += fmt::format("{:<12} {:<14} {:>9.3f} {:<4} {:>11.3f} {}\n",
                       found.sensors[static_cast<std::size_t>(term.sensor)],
                       to_string(term.error) + (term.is_slope ? " slope" : ""),
                       term.value / unit_of(term), unit_text(term),
                       2.0 * term.sigma / unit_of(term), unit_text(term));
  }
  for (Index k = 0; k < 3; ++k) {
    if (!(found.before[k] > 0.0)) continue;
    out += fmt::format("drift along {}: {:.2f} um rms, {:.2f} um with these errors compensated\n",
                       "XYZ"[k], found.before[k] / um, found.after[k] / um);
  }
  return out;
}

std::string heat_json(const HeatRegression& found) {
  system::JsonObject out;
  for (const HeatTerm& term : found.terms) {
    system::JsonObject one;
    one.number("value", term.value / unit_of(term));
    one.number("U", 2.0 * term.sigma / unit_of(term));
    one.text("unit", unit_text(term));
    out.raw(key_of(term, found.sensors[static_cast<std::size_t>(term.sensor)]), one.line());
  }
  for (Index k = 0; k < 3; ++k) {
    if (!(found.before[k] > 0.0)) continue;
    out.number(fmt::format("drift_{}_um", "XYZ"[k]), found.before[k] / um);
    out.number(fmt::format("residual_{}_um", "XYZ"[k]), found.after[k] / um);
  }
  return out.line();
}

}  // namespace servomill::sim::calibration

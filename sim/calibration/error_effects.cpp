#include "sim/calibration/error_effects.h"

#include <cmath>

#include "sim/calibration/short_waves.h"
#include "sim/model/unit_error.h"

namespace servomill::sim::calibration {
namespace {

constexpr double kNothing = 1e-12;  // m per m, of an effect that is rounding

}  // namespace

ErrorEffects::ErrorEffects(const plant::MachineChain& chain, const Unknowns& unknowns)
    : chain_(chain), unknowns_(unknowns), size_(unknowns.size()) {
  int lines = 0;
  for (const SoughtFunction& function : unknowns.functions) {
    line_of_.push_back(lines);
    lines += function.basis.lines();
  }
  // Values of a function are those of its basis less the mean and slope over the travel, which the
  // conventions give to location errors and set-ups. That part is a dense block of few rows: kept
  // as P, rows of readings stay sparse.
  P_ = Eigen::MatrixXd::Zero(lines, size_);
  for (std::size_t f = 0; f < unknowns.functions.size(); ++f) {
    const SoughtFunction& function = unknowns.functions[f];
    P_.block(line_of_[f], function.first, function.basis.lines(), function.basis.size()) =
        function.basis.projection();
  }
  const auto add = [&](const plant::ErrorName& name) {
    unit_.emplace_back(chain, model::unit_error(name));
  };
  for (const SoughtLocation& location : unknowns.locations) add(location.name);
  for (const SoughtFunction& function : unknowns.functions) add(function.name);
  for (const SoughtGrid& grid : unknowns.grids) add(grid.name);
}

void ErrorEffects::visit(const Pose& pose, const std::function<void(int, double)>& add) const {
  std::size_t k = 0;
  for (; k < unknowns_.locations.size(); ++k) {
    add(unknowns_.first_location() + static_cast<int>(k),
        // Effects are linear in the errors: one machine with a single unit error each gives the
        // column.
        pose.weight * unit_[k].first_order_at(pose) / model::kUnitError);
  }
  std::vector<BasisValue> values;
  for (std::size_t f = 0; f < unknowns_.functions.size(); ++f) {
    const SoughtFunction& function = unknowns_.functions[f];
    const double effect = pose.weight * unit_[k + f].first_order_at(pose) / model::kUnitError;
    if (std::abs(effect) < kNothing) continue;
    const int joint = *chain_.layout.joint_of(function.name.axis);
    values.clear();
    function.basis.evaluate(pose.Q[joint], pose.direction[static_cast<std::size_t>(joint)], values);
    for (const BasisValue& value : values) {
      // Behind the unknowns: columns of the conventions, which P turns into unknowns (row()).
      const int column = value.index < function.basis.size()
                             ? function.first + value.index
                             : size_ + line_of_[f] + value.index - function.basis.size();
      add(column, effect * value.value);
    }
  }
  visit_grids(pose, add);
}

void ErrorEffects::visit_grids(const Pose& pose,
                               const std::function<void(int, double)>& add) const {
  const std::size_t first_unit = unknowns_.locations.size() + unknowns_.functions.size();
  std::vector<BasisValue> values;
  for (std::size_t g = 0; g < unknowns_.grids.size(); ++g) {
    const SoughtGrid& grid = unknowns_.grids[g];
    const double effect =
        pose.weight * unit_[first_unit + g].first_order_at(pose) / model::kUnitError;
    if (std::abs(effect) < kNothing) continue;
    const auto& axes = grid.basis.form().axes;
    values.clear();
    grid.basis.evaluate(pose.Q[*chain_.layout.joint_of(axes[0])],
                        pose.Q[*chain_.layout.joint_of(axes[1])], values);
    for (const BasisValue& value : values) add(grid.first + value.index, effect * value.value);
  }
}

int ErrorEffects::joint_of(std::size_t f) const {
  return *chain_.layout.joint_of(unknowns_.functions[f].name.axis);
}

Eigen::Vector3d ErrorEffects::unit_shift(std::size_t f, const Joints& Q,
                                         const Eigen::Vector3d& p_ST) const {
  Eigen::Vector3d out;
  for (int k = 0; k < 3; ++k) {
    Pose pose;
    pose.Q = Q;
    pose.p_ST = p_ST;
    pose.n_W = Eigen::Vector3d::Unit(k);
    out[k] = unit_[unknowns_.locations.size() + f].first_order_at(pose) / model::kUnitError;
  }
  return out;
}

Eigen::RowVectorXd ErrorEffects::row(const Pose& pose) const {
  Eigen::RowVectorXd all = Eigen::RowVectorXd::Zero(size_ + lines());
  visit(pose, [&](int column, double value) { all[column] += value; });
  // A row of the design matrix: d = (a - b P) x.
  return all.head(size_) - all.tail(lines()) * P_;
}

Eigen::Matrix3d tip_covariance(const ErrorEffects& effects, const Adjustment& adjustment,
                               const Joints& Q, const Eigen::Vector3d& p_ST) {
  Eigen::MatrixXd J(3, effects.size());
  for (int k = 0; k < 3; ++k) {
    Pose pose;
    pose.Q = Q;
    pose.p_ST = p_ST;
    pose.n_W = Eigen::Vector3d::Unit(k);
    J.row(k) = effects.row(pose);
  }
  Eigen::Matrix3d out = J * adjustment.covariance * J.transpose();
  for (std::size_t f = 0; f < adjustment.short_waves.size(); ++f) {
    const double wave = adjustment.short_waves[f];
    if (wave == 0.0) continue;
    const Eigen::Vector3d effect = effects.unit_shift(f, Q, p_ST);
    const SoughtFunction& function = adjustment.unknowns.functions[f];
    const double s = Q[effects.joint_of(f)];
    // Short waves add an independent variance between the knots, in the direction in which the
    // error moves the tip.
    out += wave * wave * interpolation_variance(function.basis, s) * effect * effect.transpose();
  }
  return out;
}

}  // namespace servomill::sim::calibration

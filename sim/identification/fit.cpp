#include "sim/identification/fit.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "plant/vocabulary/progress.h"

namespace servomill::sim::identification {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kDifference = 1e-2;  // of a scale: far above rounding, far below curvature

double rms_of(const Eigen::VectorXd& x) {
  return x.size() == 0 ? 0.0 : std::sqrt(x.squaredNorm() / static_cast<double>(x.size()));
}

// The residual and its derivatives, in scaled parameters: those that have an effect.
class Differences {
 public:
  Differences(const Prediction& prediction, const Mask& mask)
      : prediction_(prediction), mask_(mask) {}

  std::optional<Eigen::VectorXd> residual(const Values& at) const {
    const auto signals = simulated({&at, 1});
    if (!signals.front()) return std::nullopt;
    return prediction_.residual(*signals.front(), mask_);
  }

  // One-sided differences, to the side that is possible; half the work of central ones.
  // @param steps  0 or NaN: the column is 0
  // @return columns of NaN where neither side is possible
  Eigen::MatrixXd slopes(const Values& at, const Values& steps, const Eigen::VectorXd& here) const {
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(here.size(), static_cast<Eigen::Index>(steps.size()));
    std::vector<std::size_t> open;
    for (std::size_t p = 0; p < steps.size(); ++p) {
      if (std::isfinite(steps[p]) && steps[p] != 0.0) open.push_back(p);
    }
    for (const double sign : {1.0, -1.0}) {
      std::vector<Values> sides;
      for (const std::size_t p : open) {
        sides.push_back(at);
        sides.back()[p] += sign * steps[p];
      }
      const auto signals = simulated(sides);
      std::vector<std::size_t> refused;
      for (std::size_t n = 0; n < open.size(); ++n) {
        if (!signals[n]) {
          refused.push_back(open[n]);
          continue;
        }
        J.col(static_cast<Eigen::Index>(open[n])) =
            (prediction_.residual(*signals[n], mask_) - here) / (sign * steps[open[n]]);
      }
      open = std::move(refused);
    }
    for (const std::size_t p : open) J.col(static_cast<Eigen::Index>(p)).setConstant(kNaN);
    return J;
  }

  // Central differences where both sides are possible, else one-sided.
  // @param steps  0 or NaN: the column is 0
  std::optional<Eigen::MatrixXd> jacobian(const Values& at, const Values& steps,
                                          const Eigen::VectorXd& here) const {
    std::vector<Values> sides;
    for (std::size_t p = 0; p < steps.size(); ++p) {
      for (const double sign : {1.0, -1.0}) {
        sides.push_back(at);
        if (std::isfinite(steps[p])) sides.back()[p] += sign * steps[p];
      }
    }
    const auto signals = simulated(sides);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(here.size(), static_cast<Eigen::Index>(steps.size()));
    for (std::size_t p = 0; p < steps.size(); ++p) {
      if (!std::isfinite(steps[p]) || steps[p] == 0.0) continue;
      const auto& up = signals[2 * p];
      const auto& down = signals[2 * p + 1];
      if (!up && !down) return std::nullopt;
      const Eigen::VectorXd above = up ? prediction_.residual(*up, mask_) : here;
      const Eigen::VectorXd below = down ? prediction_.residual(*down, mask_) : here;
      J.col(static_cast<Eigen::Index>(p)) = (above - below) / (steps[p] * (up && down ? 2.0 : 1.0));
    }
    return J;
  }

 private:
  std::vector<std::optional<Prediction::Signals>> simulated(std::span<const Values> values) const {
    auto out = prediction_.simulate(values);
    simulations_.advance(static_cast<double>(values.size()));
    return out;
  }

  const Prediction& prediction_;
  const Mask& mask_;
  mutable Stage simulations_{"simulations", 0.0, Steps::unlike};
};

// First guess of a change that matters.
double first_step(const Prediction& prediction, std::size_t parameter, double value) {
  if (parameter >= prediction.estimates()) return 1e-7;  // m, m/s
  return value != 0.0 ? 1e-4 * std::abs(value) : 1e-6;
}

// Search for the change of one parameter that matters, round by round.
class ScaleSearch {
 public:
  explicit ScaleSearch(double step) : step_(step) {}

  double scale() const { return scale_; }
  double step() const { return std::isfinite(scale_) ? kNaN : step_; }
  // @param change  of the feedback by the step; NaN: the step is refused
  void look(double change, double wanted) {
    // Between the two the response counts as linear, and one division gives the scale; far beyond,
    // the next step is shrunk and tried again.
    constexpr double kFar = 100.0, kNothing = 1e-4;
    if (std::isfinite(scale_)) return;
    if (std::isnan(change)) {
      step_ *= 0.1;
    } else if (change <= kNothing * wanted) {
      step_ *= 10.0;
    } else if (change < kFar * wanted) {
      scale_ = step_ * wanted / change;
    } else {
      step_ *= wanted / change;
    }
  }

 private:
  double step_, scale_ = kNaN;
};

// Change of each parameter that moves the feedback by `wanted` (rms); NaN where none does.
Values find_scales(const Prediction& prediction, const Differences& differences, const Values& at,
                   const Eigen::VectorXd& here, double wanted) {
  // Ten-fold steps: fourteen span all that a first guess can be wrong by.
  constexpr int kRounds = 14;
  std::vector<ScaleSearch> searches;
  for (std::size_t p = 0; p < at.size(); ++p) {
    searches.emplace_back(first_step(prediction, p, at[p]));
  }
  Values steps(at.size()), scales(at.size());
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t p = 0; p < at.size(); ++p) steps[p] = searches[p].step();
    if (std::none_of(steps.begin(), steps.end(), [](double x) { return std::isfinite(x); })) break;
    const Eigen::MatrixXd J = differences.slopes(at, steps, here);
    for (std::size_t p = 0; p < at.size(); ++p) {
      searches[p].look(rms_of(J.col(static_cast<Eigen::Index>(p))) * steps[p], wanted);
    }
  }
  constexpr double kMin = 1e-9;  // of a value: smaller steps are lost in its rounding
  for (std::size_t p = 0; p < at.size(); ++p) {
    scales[p] = searches[p].scale();
    if (std::isfinite(scales[p])) scales[p] = std::max(scales[p], kMin * std::abs(at[p]));
  }
  return scales;
}

// The cost function as Ceres wants it. Beyond a bound a parameter stays there: the bounds of Ceres
// make it search along lines, which costs more than it saves.
class Cost : public ceres::CostFunction {
 public:
  Cost(const Prediction& prediction, const Differences& differences, const Fit& fit,
       std::vector<std::size_t> active)
      : prediction_(prediction), differences_(differences), fit_(fit), active_(std::move(active)) {
    set_num_residuals(static_cast<int>(fit.residual.size()));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(active_.size()));
    unit_ = std::max(rms_of(fit.residual), std::numeric_limits<double>::min());
  }

  Values values(const double* y) const {
    Values at = fit_.values;
    for (std::size_t k = 0; k < active_.size(); ++k) {
      const std::size_t p = active_[k];
      const auto [lower, upper] = prediction_.bounds(p);
      at[p] = std::clamp(at[p] + y[k] * fit_.scales[p], lower, upper);
    }
    return at;
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Values at = values(parameters[0]);
    // the minimiser asks for the derivatives where it has asked for the residual
    if (at != known_at_) {
      known_ = differences_.residual(at);
      known_at_ = at;
    }
    const auto& here = known_;
    if (!here) return false;
    Eigen::VectorXd::Map(residuals, here->size()) = *here / unit_;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    Values steps(at.size(), kNaN);
    for (const std::size_t p : active_) steps[p] = kDifference * fit_.scales[p];
    const Eigen::MatrixXd J = differences_.slopes(at, steps, *here);
    if (!J.allFinite()) return false;
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    Eigen::Map<Rows> into(jacobians[0], here->size(), static_cast<Eigen::Index>(active_.size()));
    for (std::size_t k = 0; k < active_.size(); ++k) {
      into.col(static_cast<Eigen::Index>(k)) =
          J.col(static_cast<Eigen::Index>(active_[k])) * (fit_.scales[active_[k]] / unit_);
    }
    return true;
  }

 private:
  const Prediction& prediction_;
  const Differences& differences_;
  const Fit& fit_;
  std::vector<std::size_t> active_;
  double unit_;
  mutable Values known_at_;
  mutable std::optional<Eigen::VectorXd> known_;
};

bool is_at_bound(const Prediction& prediction, const Fit& fit, std::size_t parameter) {
  const auto [lower, upper] = prediction.bounds(parameter);
  return fit.values[parameter] <= lower || fit.values[parameter] >= upper;
}

// One run of the minimiser from fit.values on, for the parameters that are given.
void minimise(const Prediction& prediction, const Differences& differences,
              const std::vector<std::size_t>& active, Fit& fit) {
  if (active.empty()) return;
  std::vector<double> y(active.size(), 0.0);
  ceres::Problem::Options own;
  own.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  Cost cost(prediction, differences, fit, active);
  ceres::Problem problem(own);
  problem.AddResidualBlock(&cost, nullptr, y.data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.max_num_iterations = 60;
  options.function_tolerance = 1e-7;  // of the cost: far below what its noise tells
  options.parameter_tolerance = 1e-8;
  options.num_threads = 1;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  fit.values = cost.values(y.data());
  fit.iterations += static_cast<int>(summary.iterations.size());
  fit.converged = summary.termination_type == ceres::CONVERGENCE;
  fit.message = summary.message;
}

// The same for all that have an effect; then without those that have ended at a bound.
void minimise(const Prediction& prediction, const Differences& differences, Fit& fit) {
  std::vector<std::size_t> active;
  for (std::size_t p = 0; p < fit.values.size(); ++p) {
    if (std::isfinite(fit.scales[p])) active.push_back(p);
  }
  minimise(prediction, differences, active, fit);
  const std::size_t all = active.size();
  std::erase_if(active, [&](std::size_t p) { return is_at_bound(prediction, fit, p); });
  if (active.size() < all) minimise(prediction, differences, active, fit);
}

}  // namespace

std::optional<double> fit_others(const Prediction& prediction, const Fit& fit, const Mask& mask,
                                 std::size_t parameter, Values& values) {
  const Differences differences(prediction, mask);
  const auto first = differences.residual(values);
  if (!first) return std::nullopt;
  Fit held = fit;
  held.values = values;
  held.scales[parameter] = kNaN;
  held.residual = *first;
  minimise(prediction, differences, held);
  values = held.values;
  const auto last = differences.residual(values);
  return last ? std::optional(last->squaredNorm()) : std::nullopt;
}

double rms(const Eigen::VectorXd& residual, const Mask& mask) {
  std::size_t count = 0;
  for (const auto& record : mask) {
    count += static_cast<std::size_t>(std::count(record.begin(), record.end(), char{1}));
  }
  return count == 0 ? 0.0 : std::sqrt(residual.squaredNorm() / static_cast<double>(count));
}

namespace {

// From values of which the residual is known to a minimum.
void descend(const Prediction& prediction, const Differences& differences, Fit& out) {
  // far from the recording scales are rough, and so are differences by them: they are found again
  // where that has ended, and what had no effect may have one there
  constexpr double kFar = 5.0;
  constexpr int kMaxRuns = 4;
  double wanted = 0.0;
  for (int run = 0; run < kMaxRuns; ++run) {
    wanted = rms_of(out.residual);
    out.scales = find_scales(prediction, differences, out.values, out.residual, wanted);
    minimise(prediction, differences, out);
    out.residual = differences.residual(out.values).value();
    if (rms_of(out.residual) > wanted / kFar) break;
  }
}

// Values that have run to where they hardly matter, back where they were started from: nothing is
// left there that would bring them back. Nothing if there are none.
std::optional<Values> without_runaways(const Fit& fit, const Values& start) {
  constexpr double kHardly = 1.0;  // of a value, moves the feedback by the residual's rms
  Values out = fit.values;
  for (std::size_t p = 0; p < out.size(); ++p) {
    if (std::isfinite(fit.scales[p]) && fit.scales[p] > kHardly * std::abs(out[p]))
      out[p] = start[p];
  }
  return out == fit.values ? std::nullopt : std::optional(out);
}

}  // namespace

Fit fit(const Prediction& prediction, const Values& start, const Mask& mask) {
  const Differences differences(prediction, mask);
  Fit out;
  out.values = start;
  const auto first = differences.residual(start);
  if (!first) prediction.refuse(start);
  out.residual = *first;
  descend(prediction, differences, out);
  if (const auto other = without_runaways(out, start)) {
    Fit again = out;
    again.values = *other;
    if (const auto residual = differences.residual(*other)) {
      again.residual = *residual;
      descend(prediction, differences, again);
      if (again.residual.squaredNorm() < out.residual.squaredNorm()) out = std::move(again);
    }
  }
  Values steps = out.scales;
  for (double& step : steps) step *= kDifference;
  out.jacobian = differences.jacobian(out.values, steps, out.residual).value();
  return out;
}

}  // namespace servomill::sim::identification

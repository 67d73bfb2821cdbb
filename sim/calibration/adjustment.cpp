#include "sim/calibration/adjustment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "sim/calibration/error_effects.h"
#include "sim/numerics/dense_solver.h"

namespace servomill::sim::calibration {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kStartingUncertainty = 1e-6;  // m, rad, of one that is estimated
constexpr int kMaxIterations = 30;
constexpr double kSettled = 1e-4;     // relative, of estimated uncertainties
constexpr double kStill = 1e-12;      // m, rad, of the last step
constexpr double kHuber = 2.0;        // standard uncertainties
constexpr double kControlled = 1e-6;  // redundancy of a number below which nothing controls it

// A row of the Jacobian: plain functions and lines (FunctionBasis), without zeros.
struct SparseRow {
  std::vector<int> columns;
  std::vector<double> values;
};

class Adjuster {
 public:
  Adjuster(const readings::Readings& readings, const Observations& observations,
           const plant::MachineChain& chain, Unknowns unknowns, const AdjustmentOptions& options)
      : readings_(readings), observations_(observations), chain_(chain), options_(options) {
    out_.unknowns = std::move(unknowns);
    const ErrorEffects effects(chain, out_.unknowns);
    size_ = effects.size();
    P_ = effects.projection();
    set_rows(effects);
    weights_ = VectorXd::Ones(Eigen::Index(observations.all.size()));
    for (const readings::Group& group : readings.groups) {
      out_.groups.push_back({.uncertainty = group.uncertainty.value_or(kStartingUncertainty)});
    }
    out_.values = VectorXd::Zero(size_);
  }

  Adjustment run() {
    VectorXd expected = VectorXd::Zero(size_);
    for (int u = out_.unknowns.first_location(); u < size_; ++u) {
      const double size = *out_.unknowns.prior(u);
      expected[u] = 1.0 / (size * size);
    }
    Stage stage("iterations", 0.0, Steps::unlike);
    for (out_.iterations = 1;; ++out_.iterations) {
      throw_if_interrupted();
      set_residuals();
      const NormalEquations equations(normal_matrix(), kOwnShare, expected);
      const VectorXd step = equations.solve(right_side());
      out_.values += step;
      out_.left_out = equations.left_out();
      const bool settled = update_weights(equations);
      stage.advance();
      out_.converged = settled && largest_effect(step) < kStill;
      if (out_.converged || out_.iterations == kMaxIterations) {
        out_.covariance = equations.inverse();
        break;
      }
    }
    set_residuals();
    finish();
    return std::move(out_);
  }

 private:
  void set_rows(const ErrorEffects& effects) {
    VectorXd dense = VectorXd::Zero(size_ + P_.rows());
    for (const Observation& one : observations_.all) {
      SparseRow row;
      const auto add = [&](int column, double value) {
        if (value == 0.0) return;
        if (dense[column] == 0.0) row.columns.push_back(column);
        dense[column] += value;
      };
      for (const SetUpPart& part : one.set_up) add(static_cast<int>(part.unknown), part.factor);
      for (const Pose& pose : one.poses) effects.visit(pose, add);
      std::sort(row.columns.begin(), row.columns.end());
      row.columns.erase(std::unique(row.columns.begin(), row.columns.end()), row.columns.end());
      for (const int column : row.columns) {
        row.values.push_back(dense[column]);
        dense[column] = 0.0;
      }
      rows_.push_back(std::move(row));
    }
  }

  // Observed less what the machine with the present errors would show.
  void set_residuals() {
    out_.errors = plant::ErrorModel();
    const Unknowns& unknowns = out_.unknowns;
    for (std::size_t k = 0; k < unknowns.locations.size(); ++k) {
      out_.errors.location(unknowns.locations[k].name) =
          out_.values[unknowns.first_location() + static_cast<int>(k)];
    }
    for (const SoughtFunction& function : unknowns.functions) {
      out_.errors.component(function.name) =
          function.basis.function(out_.values.segment(function.first, function.basis.size()));
    }
    for (const SoughtGrid& grid : unknowns.grids) {
      out_.errors.component(grid.name).grids.emplace_back(
          grid.basis.points(out_.values.segment(grid.first, grid.basis.size())));
    }
    const Deviations machine(chain_, out_.errors);
    out_.residuals.clear();
    for (const Observation& one : observations_.all) {
      double expected = machine.of(one);
      for (const SetUpPart& part : one.set_up) {
        expected += part.factor * out_.values[static_cast<Eigen::Index>(part.unknown)];
      }
      out_.residuals.push_back(one.d - expected);
    }
  }

  double weight(std::size_t i) const {
    const double sigma = out_.groups[observations_.all[i].group].uncertainty;
    return weights_[Eigen::Index(i)] / (sigma * sigma);
  }

  // J' W J with the lines put in: [I -P]' of plain functions and lines.
  MatrixXd normal_matrix() const {
    const Eigen::Index all = size_ + P_.rows();
    MatrixXd A = MatrixXd::Zero(all, all);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const SparseRow& row = rows_[i];
      const double w = weight(i);
      for (std::size_t b = 0; b < row.columns.size(); ++b) {
        const double factor = w * row.values[b];
        double* column = A.col(row.columns[b]).data();
        for (std::size_t a = b; a < row.columns.size(); ++a) {
          column[row.columns[a]] += factor * row.values[a];
        }
      }
    }
    A.triangularView<Eigen::StrictlyUpper>() = A.transpose().eval();
    MatrixXd out = A.topLeftCorner(size_, size_);
    const MatrixXd cross = A.topRightCorner(size_, P_.rows()) * P_;
    out -= cross + cross.transpose();
    out += P_.transpose() * A.bottomRightCorner(P_.rows(), P_.rows()) * P_;
    for (int u = 0; u < out_.unknowns.first_location(); ++u) {
      const auto prior = out_.unknowns.prior(u);
      if (prior) out(u, u) += 1.0 / (*prior * *prior);
    }
    return out;
  }

  VectorXd right_side() const {
    VectorXd all = VectorXd::Zero(size_ + P_.rows());
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double pull = weight(i) * out_.residuals[i];
      for (std::size_t a = 0; a < rows_[i].columns.size(); ++a) {
        all[rows_[i].columns[a]] += pull * rows_[i].values[a];
      }
    }
    VectorXd b = all.head(size_) - P_.transpose() * all.tail(P_.rows());
    for (int u = 0; u < size_; ++u) {
      const auto prior = out_.unknowns.prior(u);
      if (prior) b[u] -= out_.values[u] / (*prior * *prior);
    }
    return b;
  }

  // Covariance of plain functions and lines.
  MatrixXd with_lines(const MatrixXd& covariance) const {
    const Eigen::Index all = size_ + P_.rows();
    MatrixXd C(all, all);
    C.topLeftCorner(size_, size_) = covariance;
    C.bottomLeftCorner(P_.rows(), size_) = -P_ * covariance;
    C.topRightCorner(size_, P_.rows()) = C.bottomLeftCorner(P_.rows(), size_).transpose();
    C.bottomRightCorner(P_.rows(), P_.rows()) =
        -C.bottomLeftCorner(P_.rows(), size_) * P_.transpose();
    return C;
  }

  // Share of each number that the unknowns take up: row (J' W J)^-1 row' weight.
  VectorXd leverages(const MatrixXd& covariance) const {
    const MatrixXd C = with_lines(covariance);
    VectorXd out(Eigen::Index(rows_.size()));
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const SparseRow& row = rows_[i];
      double sum = 0.0;
      for (std::size_t b = 0; b < row.columns.size(); ++b) {
        const double* column = C.col(row.columns[b]).data();
        double part = 0.5 * column[row.columns[b]] * row.values[b];
        for (std::size_t a = b + 1; a < row.columns.size(); ++a) {
          part += column[row.columns[a]] * row.values[a];
        }
        sum += 2.0 * row.values[b] * part;
      }
      out[Eigen::Index(i)] = std::clamp(sum * weight(i), 0.0, 1.0);
    }
    return out;
  }

  // Uncertainties that are to be estimated, by the redundancy of each group, and Huber's weights.
  // True where they no longer change.
  bool update_weights(const NormalEquations& equations) {
    const bool estimates = std::any_of(readings_.groups.begin(), readings_.groups.end(),
                                       [](const readings::Group& g) { return !g.uncertainty; });
    if (!estimates && !options_.robust) return true;
    set_residuals();
    const VectorXd h = leverages(equations.inverse());
    double change = estimates ? update_uncertainties(h) : 0.0;
    if (options_.robust) change = std::max(change, update_huber(h));
    return change < kSettled;
  }

  // Groups of one kind and instrument have one uncertainty: a single line could be fitted by the
  // functions alone, and would seem to have none.
  bool share_uncertainty(std::size_t a, std::size_t b) const {
    const readings::Group &one = readings_.groups[a], &other = readings_.groups[b];
    return !one.uncertainty && !other.uncertainty && one.kind == other.kind &&
           one.instrument == other.instrument &&
           readings::is_angular(one.kind, one.axis) == readings::is_angular(other.kind, other.axis);
  }

  double update_uncertainties(const VectorXd& h) {
    std::vector<double> squares(out_.groups.size(), 0.0), redundancy(out_.groups.size(), 0.0);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const std::size_t g = observations_.all[i].group;
      squares[g] += weights_[Eigen::Index(i)] * out_.residuals[i] * out_.residuals[i];
      redundancy[g] += 1.0 - h[Eigen::Index(i)];
    }
    double change = 0.0;
    for (std::size_t g = 0; g < out_.groups.size(); ++g) {
      if (readings_.groups[g].uncertainty) continue;
      double all_squares = 0.0, all_redundancy = 0.0;
      for (std::size_t k = 0; k < out_.groups.size(); ++k) {
        if (!share_uncertainty(g, k)) continue;
        all_squares += squares[k];
        all_redundancy += redundancy[k];
      }
      if (all_redundancy < 1.0) refuse_estimate(readings_.groups[g]);
      const double found = std::max(std::sqrt(all_squares / all_redundancy), kMinUncertainty);
      change = std::max(change, std::abs(found / out_.groups[g].uncertainty - 1.0));
      out_.groups[g].uncertainty = found;
    }
    return change;
  }

  [[noreturn]] static void refuse_estimate(const readings::Group& group) {
    throw InputError(group.place,
                     fmt::format("group \"{}\" has too few readings to estimate their uncertainty; "
                                 "give uncertainty_um or uncertainty_urad",
                                 group.name));
  }

  double update_huber(const VectorXd& h) {
    double change = 0.0;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const double sigma = out_.groups[observations_.all[i].group].uncertainty;
      const double own = std::max(1.0 - h[Eigen::Index(i)], kControlled);
      const double size = std::abs(out_.residuals[i]) / (sigma * std::sqrt(own));
      const double w = size > kHuber ? kHuber / size : 1.0;
      change = std::max(change, std::abs(w - weights_[Eigen::Index(i)]));
      weights_[Eigen::Index(i)] = w;
    }
    return change;
  }

  double largest_effect(const VectorXd& step) const {
    double most = 0.0;
    const VectorXd line = -P_ * step;
    for (const SparseRow& row : rows_) {
      double sum = 0.0;
      for (std::size_t a = 0; a < row.columns.size(); ++a) {
        const int column = row.columns[a];
        sum += row.values[a] * (column < size_ ? step[column] : line[column - size_]);
      }
      most = std::max(most, std::abs(sum));
    }
    return most;
  }

  // Numbers of one target: of all lines of an axis at one place, else of one group and place.
  std::vector<std::vector<std::size_t>> targets() const {
    std::map<std::vector<double>, std::vector<std::size_t>> found;
    constexpr double kGrid = 1e6;  // 1/m, 1/rad
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      const Observation& one = observations_.all[i];
      const readings::Group& group = readings_.groups[one.group];
      const Joints& Q = one.poses.front().Q;
      std::vector<double> key;
      if (group.axis) {
        const int joint = *chain_.layout.joint_of(*group.axis);
        key = {-1.0, double(joint), std::round(Q[joint] * kGrid)};
      } else {
        key = {double(one.group)};
        for (const double q : Q) key.push_back(std::round(q * kGrid));
      }
      found[key].push_back(i);
    }
    std::vector<std::vector<std::size_t>> out;
    for (auto& [key, numbers] : found) out.push_back(std::move(numbers));
    return out;
  }

  // Left out, the numbers of a target have the whitened residuals (I - H)^-1 r, H their part of
  // the projection on the unknowns (Allen's prediction sum of squares, for blocks).
  double prediction_error() const {
    const MatrixXd C = with_lines(out_.covariance);
    double squares = 0.0;
    for (const std::vector<std::size_t>& numbers : targets()) {
      const auto n = static_cast<Eigen::Index>(numbers.size());
      MatrixXd A = MatrixXd::Zero(n, C.rows());
      VectorXd r(n);
      for (Eigen::Index k = 0; k < n; ++k) {
        const std::size_t i = numbers[std::size_t(k)];
        const double root = std::sqrt(weight(i));
        for (std::size_t a = 0; a < rows_[i].columns.size(); ++a) {
          A(k, rows_[i].columns[a]) = root * rows_[i].values[a];
        }
        r[k] = root * out_.residuals[i];
      }
      const MatrixXd rest = MatrixXd::Identity(n, n) - A * C * A.transpose();
      const MatrixXd controlled = rest + kControlled * MatrixXd::Identity(n, n);
      squares += numerics::solve_symmetric(controlled, r).squaredNorm();
    }
    return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(rows_.size(), 1)));
  }

  void finish() {
    if (options_.predicts) out_.prediction = prediction_error();
    const VectorXd h = leverages(out_.covariance);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      GroupResult& group = out_.groups[observations_.all[i].group];
      const double own = 1.0 - h[Eigen::Index(i)];
      const double whitened = out_.residuals[i] / group.uncertainty;
      out_.standardized.push_back(own > kControlled ? whitened / std::sqrt(own) : 0.0);
      group.rms += out_.residuals[i] * out_.residuals[i];
      group.redundancy += own;
      ++group.numbers;
      out_.squares += weights_[Eigen::Index(i)] * whitened * whitened;
    }
    for (GroupResult& group : out_.groups) {
      out_.redundancy += group.redundancy;
      if (group.numbers > 0) group.rms = std::sqrt(group.rms / double(group.numbers));
    }
    for (int u = 0; u < out_.unknowns.first_location(); ++u) {
      const auto prior = out_.unknowns.prior(u);
      if (!prior) continue;
      out_.squares += out_.values[u] * out_.values[u] / (*prior * *prior);
      out_.redundancy += 1.0 - out_.covariance(u, u) / (*prior * *prior);
    }
  }

  static constexpr double kMinUncertainty = 1e-12;  // m, rad

  const readings::Readings& readings_;
  const Observations& observations_;
  const plant::MachineChain& chain_;
  const AdjustmentOptions& options_;
  int size_ = 0;
  MatrixXd P_;  // lines x unknowns
  std::vector<SparseRow> rows_;
  VectorXd weights_;  // of robustness
  Adjustment out_;
};

}  // namespace

Adjustment adjust(const readings::Readings& readings, const Observations& observations,
                  const plant::MachineChain& chain, std::vector<SoughtLocation> locations,
                  std::vector<SoughtFunction> functions, std::vector<SoughtGrid> grids,
                  const AdjustmentOptions& options) {
  Unknowns unknowns{.set_up = observations.set_up,
                    .locations = std::move(locations),
                    .functions = std::move(functions),
                    .grids = std::move(grids)};
  int first = unknowns.first_function();
  for (SoughtFunction& function : unknowns.functions) {
    function.first = first;
    first += function.basis.size();
  }
  for (SoughtGrid& grid : unknowns.grids) {
    grid.first = first;
    first += grid.basis.size();
  }
  return Adjuster(readings, observations, chain, std::move(unknowns), options).run();
}

}  // namespace servomill::sim::calibration

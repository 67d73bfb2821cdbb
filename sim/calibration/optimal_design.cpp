#include "sim/calibration/optimal_design.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "sim/calibration/whole_design.h"
#include "sim/numerics/dense_solver.h"

namespace servomill::sim::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// The mean of order q of the variances stands for the largest one; q grows while it settles.
constexpr double kOrders[] = {2.0, 8.0, 32.0, 128.0, 512.0};
constexpr int kStepsEach = 600;
constexpr double kFirstPower = 0.5, kMaxPower = 1.0, kMinPower = 1e-4;  // of a step
constexpr double kEnough = 0.999;   // efficiency at which an order is done
constexpr double kMinCount = 1e-9;  // of a candidate that is still looked at

}  // namespace

// Variances, and the gain of the weighted variance by time spent on each candidate.
struct DesignProblem::State {
  MatrixXd spread;  // covariance times the rows of all quantities
  std::vector<double> variances;
  double worst = 0.0;

  // Mean of order q, over the largest.
  double mean(double q) const {
    double sum = 0.0;
    for (const double v : variances) sum += std::pow(v / worst, q);
    return worst * std::pow(sum / static_cast<double>(variances.size()), 1.0 / q);
  }

  // Weights of the quantities by the mean of order q, summing to 1.
  std::vector<double> weights(double q) const {
    std::vector<double> out;
    double sum = 0.0;
    for (const double v : variances) {
      out.push_back(std::pow(v / worst, q - 1.0));
      sum += out.back();
    }
    for (double& weight : out) weight /= sum;
    return out;
  }
};

DesignProblem::DesignProblem(std::vector<Candidate> candidates, MatrixXd known,
                             std::vector<MatrixXd> quantities)
    : candidates_(std::move(candidates)),
      known_(std::move(known)),
      quantities_(std::move(quantities)),
      first_{0} {
  for (const MatrixXd& K : quantities_) first_.push_back(first_.back() + K.rows());
  rows_.resize(known_.rows(), first_.back());
  for (std::size_t p = 0; p < quantities_.size(); ++p) {
    rows_.middleCols(first_[p], quantities_[p].rows()) = quantities_[p].transpose();
  }
}

double DesignProblem::total_time(const std::vector<double>& counts) const {
  double out = 0.0;
  for (std::size_t i = 0; i < counts.size(); ++i) out += counts[i] * candidates_[i].time;
  return out;
}

DesignProblem::State DesignProblem::state_of(const std::vector<double>& counts) const {
  MatrixXd M = known_;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] > 0.0) M += counts[i] * candidates_[i].information;
  }
  State out;
  out.spread.noalias() = numerics::inverse_of_definite(M) * rows_;
  for (std::size_t p = 0; p < quantities_.size(); ++p) {
    double variance = 0.0;
    for (Index k = first_[p]; k < first_[p + 1]; ++k)
      variance += out.spread.col(k).dot(rows_.col(k));
    out.variances.push_back(variance);
    out.worst = std::max(out.worst, variance);
  }
  return out;
}

std::vector<double> DesignProblem::variances(const std::vector<double>& counts) const {
  return state_of(counts).variances;
}

// With weights l on the quantities, V(counts) = sum l v is convex; its slope by candidate i is
// -tr(M_i Q), Q = sum l C K'K C. All time on the candidate with the steepest slope a second gives
// the bound  V* >= V + sum counts_i slope_i - time max(slope/time).
Design DesignProblem::relaxed(double time) const {
  Design out;
  double all = 0.0;
  for (const Candidate& one : candidates_) all += one.time;
  std::vector<double> counts(candidates_.size(), time / all);
  State state = state_of(counts);
  out.counts = counts;
  out.worst = state.worst;
  Stage stage("steps", 0.0, Steps::unlike);
  for (const double q : kOrders) {
    double power = kFirstPower;
    for (int step = 0; step < kStepsEach && power > kMinPower; ++step) {
      throw_if_interrupted();
      stage.advance();
      const Gains gains = gains_of(state, q, counts, time);
      out.bound = std::max(out.bound, gains.bound);
      if (out.efficiency() > kEnough) return out;
      std::vector<double> next = counts;
      for (std::size_t i = 0; i < next.size(); ++i) {
        next[i] *= std::pow(gains.each[i] / gains.steepest, power);
      }
      const double scale = time / total_time(next);
      for (double& count : next) count *= scale;
      State there = state_of(next);
      if (there.mean(q) > state.mean(q)) {
        power *= 0.5;
        continue;
      }
      power = std::min(kMaxPower, 1.3 * power);
      counts = std::move(next);
      state = std::move(there);
      if (state.worst < out.worst) {
        out.worst = state.worst;
        out.counts = counts;
      }
    }
  }
  return out;
}

DesignProblem::Gains DesignProblem::gains_of(const State& state, double q,
                                             const std::vector<double>& counts, double time) const {
  const std::vector<double> weights = state.weights(q);
  MatrixXd weighted(rows_.rows(),
                    rows_.cols());  // columns that count, by the roots of their weights
  Index columns = 0;
  double V = 0.0;
  for (std::size_t p = 0; p < quantities_.size(); ++p) {
    if (weights[p] < kMinCount) continue;
    for (Index k = first_[p]; k < first_[p + 1]; ++k) {
      weighted.col(columns++) = std::sqrt(weights[p]) * state.spread.col(k);
    }
    V += weights[p] * state.variances[p];
  }
  weighted.conservativeResize(Eigen::NoChange, columns);
  const MatrixXd Q = weighted * weighted.transpose();
  Gains out;
  double spent = 0.0;
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    out.each.push_back(candidates_[i].information.cwiseProduct(Q).sum() / candidates_[i].time);
    out.steepest = std::max(out.steepest, out.each.back());
    spent += counts[i] * candidates_[i].time * out.each.back();
  }
  out.bound = V + spent - time * out.steepest;
  // without anything known V falls with one over the time: a sharper bound
  if (known_.isZero(0.0)) out.bound = V * V / (time * out.steepest);
  return out;
}

Design DesignProblem::whole(const Design& relaxed, double time) const {
  Design out;
  out.bound = relaxed.bound;
  out.counts = whole_counts(candidates_, known_, quantities_, relaxed.counts, time);
  out.worst = state_of(out.counts).worst;
  return out;
}

}  // namespace servomill::sim::calibration

#include "sim/calibration/whole_design.h"

#include <Eigen/Core>
#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_int_distribution.hpp>
#include <cmath>
#include <limits>
#include <tuple>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "sim/numerics/decompositions.h"
#include "sim/numerics/dense_solver.h"

namespace servomill::sim::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// A power mean approximates the worst: one candidate alone seldom lowers several worst ones.
constexpr double kOrder = 32.0;
constexpr double kRank = 1e-10;        // of the largest eigenvalue of an information
constexpr std::size_t kLookedAt = 48;  // candidates of the steepest gains, a step
constexpr double kStretches[] = {1.0, 1.6, 2.5};
constexpr int kRounds = 500;                         // of each start
constexpr int kFewestOut = 1, kMaxOut = 6;           // taken out in a round
constexpr double kSpreads[] = {0.0, 0.5, 0.0, 1.0};  // of gains, round by round
constexpr double kNothing = 1e-8;  // of a candidate's information, where nothing is known
constexpr double kGain = 1e-6;     // relative, that counts as one

// Counts with the covariance that they leave.
struct Plan {
  std::vector<double> counts;
  double left = 0.0;  // s
  MatrixXd C;         // n x n
  MatrixXd KC;        // rows of all quantities x n
  VectorXd v;         // variances
  double size = 0.0;  // mean of their order
};

class Search {
 public:
  Search(const std::vector<Candidate>& candidates, const MatrixXd& known,
         const std::vector<MatrixXd>& quantities, double time)
      : candidates_(candidates), known_(known), time_(time) {
    known_.diagonal().array() += kNothing * mean_information();
    Index rows = 0;
    for (const MatrixXd& K : quantities) rows += K.rows();
    K_.resize(rows, known.rows());
    for (const MatrixXd& K : quantities) {
      const auto first = static_cast<Index>(owner_.size());
      K_.middleRows(first, K.rows()) = K;
      owner_.insert(owner_.end(), std::size_t(K.rows()), quantity_count_++);
    }
    for (const Candidate& one : candidates) roots_.push_back(root_of(one.information));
  }

  std::vector<double> best_from(const std::vector<double>& relaxed) {
    Stage starts("starts", std::size(kStretches));
    for (const double stretch : kStretches) {
      std::vector<double> start;
      for (const double count : relaxed) start.push_back(std::floor(stretch * count + 1e-9));
      Plan plan = plan_of(fitting(std::move(start)));
      fill(plan, 0.0);
      remember(plan);
      search(plan);
      starts.advance();
    }
    return best_;
  }

 private:
  // Mean diagonal of all candidates.
  double mean_information() const {
    double sum = 0.0;
    for (const Candidate& one : candidates_) sum += one.information.trace();
    return sum / double(candidates_.size()) / double(known_.rows());
  }

  // B' of information = B'B.
  static MatrixXd root_of(const MatrixXd& information) {
    const numerics::SymmetricEigen eigen = numerics::symmetric_eigen(information);
    const Index n = eigen.values.size();
    const double least = kRank * eigen.values[n - 1];
    Index rank = 0;
    while (rank < n && eigen.values[n - 1 - rank] > std::max(least, 0.0)) ++rank;
    return eigen.vectors.rightCols(rank) * eigen.values.tail(rank).cwiseSqrt().asDiagonal();
  }

  double time_of(const std::vector<double>& counts) const {
    double out = 0.0;
    for (std::size_t i = 0; i < counts.size(); ++i) out += counts[i] * candidates_[i].time;
    return out;
  }

  // Takes out from the end until the rest fits.
  std::vector<double> fitting(std::vector<double> counts) const {
    for (std::size_t i = counts.size(); i-- > 0 && time_of(counts) > time_;) {
      while (counts[i] > 0.0 && time_of(counts) > time_) counts[i] -= 1.0;
    }
    return counts;
  }

  double size_of(const VectorXd& v) const {
    const double worst = v.maxCoeff();
    return worst * std::pow((v / worst).array().pow(kOrder).mean(), 1.0 / kOrder);
  }

  VectorXd owned_squares(const MatrixXd& rows) const {
    VectorXd out = VectorXd::Zero(quantity_count_);
    for (Index k = 0; k < rows.rows(); ++k) {
      out[owner_[std::size_t(k)]] += rows.row(k).squaredNorm();
    }
    return out;
  }

  Plan plan_of(std::vector<double> counts) const {
    MatrixXd M = known_;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (counts[i] > 0.0) M += counts[i] * candidates_[i].information;
    }
    Plan out;
    out.C = numerics::inverse_of_definite(M);
    out.KC = K_ * out.C;
    out.v = VectorXd::Zero(quantity_count_);
    for (Index k = 0; k < K_.rows(); ++k) {
      out.v[owner_[std::size_t(k)]] += out.KC.row(k).dot(K_.row(k));
    }
    out.size = size_of(out.v);
    out.left = time_ - time_of(counts);
    out.counts = std::move(counts);
    return out;
  }

  // L of L L' = I + B C B'.
  MatrixXd factor(const Plan& plan, std::size_t i) const {
    const MatrixXd& Bt = roots_[i];
    return numerics::cholesky_factor(MatrixXd::Identity(Bt.cols(), Bt.cols()) +
                                     Bt.transpose() * plan.C * Bt);
  }

  // Variances with one more of a candidate (Woodbury).
  VectorXd with(const Plan& plan, std::size_t i) const {
    const MatrixXd L = factor(plan, i);
    MatrixXd W = (plan.KC * roots_[i]).transpose();
    L.triangularView<Eigen::Lower>().solveInPlace(W);
    return plan.v - owned_squares(W.transpose());
  }

  void add(Plan& plan, std::size_t i) const {
    const MatrixXd L = factor(plan, i);
    MatrixXd U = (plan.C * roots_[i]).transpose();
    L.triangularView<Eigen::Lower>().solveInPlace(U);
    MatrixXd W = (plan.KC * roots_[i]).transpose();
    L.triangularView<Eigen::Lower>().solveInPlace(W);
    plan.C.noalias() -= U.transpose() * U;
    plan.KC.noalias() -= W.transpose() * U;
    plan.v -= owned_squares(W.transpose());
    plan.size = size_of(plan.v);
    plan.counts[i] += 1.0;
    plan.left -= candidates_[i].time;
  }

  struct Slope {
    std::size_t candidate = 0;
    double gain = 0.0;  // of size by time, at the first moment of its time
  };

  // Candidates that fit into what is left, those with the steepest gains first.
  std::vector<Slope> steepest(const Plan& plan) const {
    const VectorXd share = (plan.v / plan.v.maxCoeff()).array().pow(kOrder - 1.0);
    VectorXd weight(K_.rows());
    for (Index k = 0; k < K_.rows(); ++k) weight[k] = share[owner_[std::size_t(k)]];
    const MatrixXd Q = plan.KC.transpose() * weight.asDiagonal() * plan.KC;
    std::vector<std::pair<double, std::size_t>> gains;
    for (std::size_t i = 0; i < candidates_.size(); ++i) {
      if (candidates_[i].time > plan.left) continue;
      const double gain = candidates_[i].information.cwiseProduct(Q).sum();
      gains.emplace_back(-gain / candidates_[i].time, i);
    }
    std::sort(gains.begin(), gains.end());
    // derivative of the size: (v/size)^(order-1) over the number of quantities
    const double scale =
        std::pow(plan.v.maxCoeff() / plan.size, kOrder - 1.0) / double(quantity_count_);
    std::vector<Slope> out;
    for (std::size_t k = 0; k < std::min(gains.size(), kLookedAt); ++k) {
      out.push_back({gains[k].second, -gains[k].first * scale});
    }
    return out;
  }

  // Adds what lowers the size most for its time as long as there is time. Gains are multiplied by
  // random factors of this spread: what is best alone is not always best together.
  // The size is convex: no candidate gains more than its slope promises.
  void fill(Plan& plan, double spread) {
    for (;;) {
      double best_gain = 0.0;
      std::size_t best = candidates_.size();
      for (const auto& [i, slope] : steepest(plan)) {
        const double factor = spread > 0.0 ? std::exp(spread * normal_(generator_)) : 1.0;
        if (slope * factor * (1.0 + kGain) < best_gain) continue;
        const double gain = factor * (plan.size - size_of(with(plan, i))) / candidates_[i].time;
        if (gain > best_gain) std::tie(best_gain, best) = std::pair(gain, i);
      }
      if (best == candidates_.size()) break;
      add(plan, best);
    }
    plan = plan_of(std::move(plan.counts));  // without the rounding of many steps
  }

  // The search follows the mean; what counts in the end is the worst.
  void remember(const Plan& plan) {
    const double worst = plan.v.maxCoeff();
    if (worst < best_worst_) std::tie(best_worst_, best_) = std::tie(worst, plan.counts);
  }

  void search(Plan& plan) {
    using Draw = boost::random::uniform_int_distribution<std::size_t>;
    Stage rounds("", kRounds);
    for (int round = 0; round < kRounds; ++round) {
      throw_if_interrupted();
      rounds.advance();
      std::vector<std::size_t> taken;
      for (std::size_t i = 0; i < plan.counts.size(); ++i) {
        taken.insert(taken.end(), std::size_t(plan.counts[i]), i);
      }
      if (taken.empty()) return;
      std::vector<double> counts = plan.counts;
      const std::size_t out = Draw(kFewestOut, kMaxOut)(generator_);
      for (std::size_t k = 0; k < std::min(out, taken.size()); ++k) {
        const std::size_t at = Draw(k, taken.size() - 1)(generator_);
        std::swap(taken[k], taken[at]);
        counts[taken[k]] -= 1.0;
      }
      Plan other = plan_of(std::move(counts));
      fill(other, kSpreads[round % int(std::size(kSpreads))]);
      remember(other);
      if (other.size < plan.size * (1.0 - kGain)) plan = std::move(other);
    }
  }

  const std::vector<Candidate>& candidates_;
  MatrixXd known_;
  double time_;
  Index quantity_count_ = 0;
  MatrixXd K_;
  std::vector<Index> owner_;     // quantity of each row of K
  std::vector<MatrixXd> roots_;  // n x rank
  double best_worst_ = std::numeric_limits<double>::infinity();
  std::vector<double> best_;
  boost::random::mt19937_64 generator_{1};
  boost::random::normal_distribution<double> normal_;
};

}  // namespace

std::vector<double> whole_counts(const std::vector<Candidate>& candidates, const MatrixXd& known,
                                 const std::vector<MatrixXd>& quantities,
                                 const std::vector<double>& relaxed, double time) {
  return Search(candidates, known, quantities, time).best_from(relaxed);
}

}  // namespace servomill::sim::calibration

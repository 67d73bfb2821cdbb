#include "sim/calibration/normal_equations.h"

#include <Eigen/Core>
#include <cmath>

#include "sim/numerics/dense_solver.h"

namespace servomill::sim::calibration {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

NormalEquations::NormalEquations(const MatrixXd& A, double own_share, const VectorXd& expected)
    : size_(A.rows()), scale_(A.diagonal().cwiseMax(0.0).cwiseSqrt()) {
  const auto has_effect = [&](Index j) { return scale_[j] > kNoEffect; };
  // Cholesky without pivoting, on A scaled to a unit diagonal: the order of the unknowns decides
  // which of several dependent ones is left out (set-up before errors, README.md).
  MatrixXd rows = MatrixXd::Zero(size_, size_);  // of all unknowns, in the columns of those kept
  for (Index j = 0; j < size_; ++j) {
    if (!has_effect(j)) {
      left_out_.push_back({static_cast<int>(j), {}});
      continue;
    }
    const auto k = static_cast<Index>(kept_.size());
    // Share of the effect that the unknowns before it cannot have: the squared diagonal of the
    // factor.
    const double own = 1.0 - rows.row(j).head(k).squaredNorm();
    if (own < own_share * own_share) {
      left_out_.push_back({static_cast<int>(j), {}});
      continue;
    }
    const Index below = size_ - j;
    VectorXd column = A.col(j).tail(below) / scale_[j];
    for (Index i = 0; i < below; ++i) {
      column[i] = has_effect(j + i) ? column[i] / scale_[j + i] : 0.0;
    }
    column.noalias() -= rows.block(j, 0, below, k) * rows.row(j).head(k).transpose();
    rows.col(k).tail(below) = column / std::sqrt(own);
    kept_.push_back(static_cast<int>(j));
  }
  const auto n = static_cast<Index>(kept_.size());
  L_.resize(n, n);
  for (Index i = 0; i < n; ++i) L_.row(i) = rows.row(kept_[static_cast<std::size_t>(i)]).head(n);
  for (Dependent& one : left_out_) {
    if (!has_effect(one.unknown)) continue;
    // only those kept before it have numbers in its row
    // Least squares of the column that is left out on those kept, read off the factor: L' share =
    // row. The readings determine x_kept + factor x_left in place of x_kept.
    VectorXd share = rows.row(one.unknown).head(n).transpose();
    L_.transpose().triangularView<Eigen::Upper>().solveInPlace(share);
    for (Index i = 0; i < n; ++i) {
      const int unknown = kept_[static_cast<std::size_t>(i)];
      if (std::abs(share[i]) > own_share) {
        one.parts.push_back({.unknown = unknown,
                             .factor = share[i] * scale_[one.unknown] / scale_[unknown],
                             .share = share[i]});
      }
    }
  }
  if (expected.isZero(0.0)) return;
  // Priors enter only now: added before, they would make every dependent unknown look determined.
  MatrixXd whole = L_ * L_.transpose();
  for (Index i = 0; i < n; ++i) {
    const int unknown = kept_[static_cast<std::size_t>(i)];
    whole(i, i) += expected[unknown] / (scale_[unknown] * scale_[unknown]);
  }
  L_ = numerics::cholesky_factor(whole);
}

VectorXd NormalEquations::solve(const VectorXd& b) const {
  const auto n = static_cast<Index>(kept_.size());
  VectorXd y(n);
  for (Index i = 0; i < n; ++i) {
    const int unknown = kept_[static_cast<std::size_t>(i)];
    y[i] = b[unknown] / scale_[unknown];
  }
  L_.triangularView<Eigen::Lower>().solveInPlace(y);
  L_.transpose().triangularView<Eigen::Upper>().solveInPlace(y);
  VectorXd x = VectorXd::Zero(size_);
  for (Index i = 0; i < n; ++i) {
    const int unknown = kept_[static_cast<std::size_t>(i)];
    x[unknown] = y[i] / scale_[unknown];
  }
  return x;
}

MatrixXd NormalEquations::inverse() const {
  const auto n = static_cast<Index>(kept_.size());
  MatrixXd inverse = MatrixXd::Identity(n, n);
  L_.triangularView<Eigen::Lower>().solveInPlace(inverse);
  // (L L')^-1 = L^-T L^-1, in the scaling of the unknowns.
  const MatrixXd product = inverse.triangularView<Eigen::Lower>().transpose() * inverse;
  MatrixXd out = MatrixXd::Zero(size_, size_);
  for (Index j = 0; j < n; ++j) {
    const int b = kept_[static_cast<std::size_t>(j)];
    for (Index i = 0; i < n; ++i) {
      const int a = kept_[static_cast<std::size_t>(i)];
      out(a, b) = product(i, j) / (scale_[a] * scale_[b]);
    }
  }
  return out;
}

}  // namespace servomill::sim::calibration

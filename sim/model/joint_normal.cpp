#include "sim/model/joint_normal.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/numerics/decompositions.h"

namespace servomill::sim::model {
namespace {

// Asymmetry of computed covariances, as a share of the standard deviations.
constexpr double kSymmetryTolerance = 1e-12;
// Eigenvalue of the correlations that rounding to some ten digits may leave below 0.
constexpr double kDefiniteTolerance = 1e-9;
// Rounding of correlations that are computed in double precision.
constexpr double kRounding = 64.0 * std::numeric_limits<double>::epsilon();

Eigen::MatrixXd symmetric(const Eigen::MatrixXd& matrix) {
  return 0.5 * (matrix + matrix.transpose());
}

// Correlations; numbers that do not scatter have rows of zeros.
Eigen::MatrixXd correlations(const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd inverse = covariance.diagonal().unaryExpr(
      [](double variance) { return variance > 0.0 ? 1.0 / std::sqrt(variance) : 0.0; });
  Eigen::MatrixXd out = inverse.asDiagonal() * symmetric(covariance) * inverse.asDiagonal();
  for (Eigen::Index i = 0; i < out.rows(); ++i) out(i, i) = inverse[i] > 0.0 ? 1.0 : 0.0;
  return out;
}

std::string fault_of_pair(const Eigen::MatrixXd& c, Eigen::Index i, Eigen::Index j) {
  const double scale = std::sqrt(c(i, i)) * std::sqrt(c(j, j));
  if (std::abs(c(i, j) - c(j, i)) > kSymmetryTolerance * scale) {
    return fmt::format("must be symmetric; [{}][{}] is {}, [{}][{}] is {}", i, j, c(i, j), j, i,
                       c(j, i));
  }
  if (std::abs(c(i, j)) > scale * (1.0 + kDefiniteTolerance)) {
    return fmt::format(
        "must be positive semi-definite; [{0}][{1}] = {2} exceeds the product {3:.6g} of both "
        "standard deviations",
        i, j, c(i, j), scale);
  }
  return {};
}

}  // namespace

std::string covariance_fault(const Eigen::MatrixXd& covariance) {
  const Eigen::Index n = covariance.rows();
  for (Eigen::Index i = 0; i < n; ++i) {
    if (covariance(i, i) < 0.0) {
      return fmt::format("must have variances >= 0; [{0}][{0}] is {1}", i, covariance(i, i));
    }
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = i + 1; j < n; ++j) {
      std::string fault = fault_of_pair(covariance, i, j);
      if (!fault.empty()) return fault;
    }
  }
  const double least = numerics::least_eigenvalue(correlations(covariance));
  if (least >= -kDefiniteTolerance) return {};
  return fmt::format(
      "must be positive semi-definite; the smallest eigenvalue of the correlation matrix is {:.3g}",
      least);
}

Eigen::MatrixXd covariance_factor(const Eigen::MatrixXd& covariance) {
  const Eigen::Index n = covariance.rows();
  Eigen::MatrixXd rest = correlations(covariance);
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(n, n);
  // Schur complements of a singular matrix end in its rounding, which its least eigenvalue shows. A
  // direction that is well known may matter more than all others: none is left out beyond that.
  const double negligible =
      2.0 * static_cast<double>(n) * std::max(kRounding, -numerics::least_eigenvalue(rest));
  Eigen::Index rank = 0;
  for (; rank < n; ++rank) {
    Eigen::Index pivot = 0;
    const double variance = rest.diagonal().maxCoeff(&pivot);
    if (!(variance > negligible)) break;
    factor.col(rank) = rest.col(pivot) / std::sqrt(variance);
    rest -= factor.col(rank) * factor.col(rank).transpose();
    rest.col(pivot).setZero();  // exactly, so that it is no pivot again
    rest.row(pivot).setZero();
  }
  return covariance.diagonal().cwiseSqrt().asDiagonal() * factor.leftCols(rank);
}

}  // namespace servomill::sim::model

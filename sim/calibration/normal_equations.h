/// Normal equations of an adjustment whose unknowns the readings do not all tell apart.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace servomill::sim::calibration {

/// Factor of a positive semi-definite matrix A by unknowns in their order, each scaled to the same
/// effect. An unknown of which less than `own_share` is its own, beside those before it, is left
/// out; one without effect, too.
///
///     A_kk = S L L' S        k: those kept, S: diagonal
///
/// Cholesky's factorisation does that in one pass: its pivot is the square of the share that is
/// new. Eigenvalues would say how many combinations are unknown, not which unknowns they are.
class NormalEquations {
 public:
  /// @param least_effect  root of a diagonal element below which an unknown has none
  NormalEquations(const Eigen::MatrixXd& A, double own_share, double least_effect);

  const std::vector<int>& kept() const { return kept_; }
  struct Dependent {
    int unknown = 0;
    std::vector<std::pair<int, double>> parts;  // as the sum of kept ones; empty: no effect
  };
  const std::vector<Dependent>& left_out() const { return left_out_; }

  /// x of A x = b, 0 for those left out.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// The inverse of A_kk, 0 in rows and columns of those left out.
  Eigen::MatrixXd inverse() const;

 private:
  Eigen::Index size_;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd L_;  // kept x kept
  std::vector<int> kept_;
  std::vector<Dependent> left_out_;
};

}  // namespace servomill::sim::calibration

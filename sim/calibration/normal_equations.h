/// Normal equations of an adjustment whose unknowns the readings do not all tell apart.
#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

namespace servomill::sim::calibration {

/// Factor of a positive semi-definite matrix A by unknowns in their order, each scaled to the same
/// effect. An unknown of which less than `own_share` is its own, beside those before it, is left
/// out; one without effect, too. What is expected of the size of unknowns plays no part in that.
///
///     A_kk + diag(expected) = S L L' S        k: those kept, S: diagonal
///
/// Cholesky's factorisation does that in one pass: its pivot is the square of the share that is
/// new. Eigenvalues would say how many combinations are unknown, not which unknowns they are.
class NormalEquations {
 public:
  /// @param A      of whitened readings
  /// @param expected  weights by which unknowns are drawn to 0: 1/size^2; 0: not at all
  NormalEquations(const Eigen::MatrixXd& A, double own_share, const Eigen::VectorXd& expected);

  const std::vector<int>& kept() const { return kept_; }
  /// Part of an unknown that is left out, in a kept one.
  struct Part {
    int unknown = 0;
    double factor = 0.0;  // of the kept unknown, for one of that left out
    double share = 0.0;   // of its effect
  };
  struct Dependent {
    int unknown = 0;
    std::vector<Part> parts;  // empty: no effect
  };
  const std::vector<Dependent>& left_out() const { return left_out_; }

  /// x of (A + diag(expected)) x = b, 0 for those left out.
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;
  /// The inverse of that matrix, 0 in rows and columns of those left out.
  Eigen::MatrixXd inverse() const;

  /// Whitened effect of one (m, rad) that counts as none: a thousandth of the noise for 1 mm.
  static constexpr double kNoEffect = 1.0;

 private:
  Eigen::Index size_;
  Eigen::VectorXd scale_;
  Eigen::MatrixXd L_;  // kept x kept
  std::vector<int> kept_;
  std::vector<Dependent> left_out_;
};

}  // namespace servomill::sim::calibration

/// Numbers that are distributed together: the multivariate normal distribution.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

namespace servomill::sim::model {

/// Mean and a factor of the covariance. The sample of independent standard normal numbers z, one
/// for each column of the factor, is mean + factor z.
struct JointNormal {
  Eigen::VectorXd mean;
  Eigen::MatrixXd factor;  // covariance = factor factor'; as many columns as its rank

  std::size_t size() const { return static_cast<std::size_t>(mean.size()); }
  std::size_t dimensions() const { return static_cast<std::size_t>(factor.cols()); }
};

/// Rule that a matrix breaks as a covariance: "must be symmetric; [0][1] is 0.1, [1][0] is 0.2";
/// empty if it is one. Positive semi-definite is decided by the matrix of correlations, so that it
/// does not depend on units.
/// @pre square, all numbers finite
std::string covariance_fault(const Eigen::MatrixXd& covariance);

/// A factor with as many columns as the covariance has rank: Cholesky with complete pivoting of the
/// matrix of correlations. Numbers that depend linearly on others lie exactly on their line.
/// @pre covariance_fault(covariance) is empty
/// Source: Higham, "Accuracy and Stability of Numerical Algorithms", 2nd ed., algorithm 10.2 and
/// section 10.3.2.
Eigen::MatrixXd covariance_factor(const Eigen::MatrixXd& covariance);

}  // namespace servomill::sim::model

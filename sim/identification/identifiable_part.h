/// The part of the parameters that a residual determines: the singular value decomposition of its
/// derivatives, scaled to columns of length 1.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace servomill::sim::identification {

struct IdentifiablePart {
  std::vector<std::size_t> parameters;  // that have an effect: one a row of `back` and V
  Eigen::VectorXd norm;                 // of their columns
  Eigen::MatrixXd U;                    // orthonormal columns of what can be fitted
  Eigen::MatrixXd back;                 // least squares: values = back U' residual
  Eigen::MatrixXd nothing;              // directions of unit columns along which nothing changes
};

/// Columns of `jacobian` that are 0 are parameters that have no effect.
IdentifiablePart identifiable_part(const Eigen::MatrixXd& jacobian);

/// Change of all values that least squares gives for a residual; 0 where there is no effect.
/// @param size  number of all values
Eigen::VectorXd least_squares(const IdentifiablePart& part, const Eigen::VectorXd& residual,
                              Eigen::Index size);

}  // namespace servomill::sim::identification

/// Dense matrices of any size. The templates behind these take longer to compile than the rest of
/// the room: this is the only source that has them.
#pragma once

#include <Eigen/Core>

namespace servomill::sim::frequency {

Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& A);

/// x of A x = b, by LU decomposition with partial pivoting. @pre A is regular
Eigen::VectorXcd solve(const Eigen::MatrixXcd& A, const Eigen::VectorXcd& b);

}  // namespace servomill::sim::frequency

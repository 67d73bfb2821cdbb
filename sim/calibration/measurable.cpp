#include "sim/calibration/measurable.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace servomill::sim::calibration {

using Eigen::Index;
using Eigen::MatrixXd;

Measurable measurable(const std::vector<Candidate>& candidates, const MatrixXd& known,
                      double time) {
  const Index n = known.rows();
  MatrixXd all = MatrixXd::Zero(n, n);
  for (const Candidate& one : candidates) all += time / one.time * one.information;
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(all, known);
  Index few = 0;  // eigenvalues rise
  while (few < n && solver.eigenvalues()[few] < 1.0) ++few;
  const MatrixXd beyond = solver.eigenvectors().leftCols(few);
  return {MatrixXd::Identity(n, n) - beyond * (beyond.transpose() * known), beyond};
}

}  // namespace servomill::sim::calibration

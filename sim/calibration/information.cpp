#include "sim/calibration/information.h"

#include <Eigen/Core>
#include <algorithm>

#include "sim/calibration/observations.h"
#include "sim/numerics/dense_solver.h"

namespace servomill::sim::calibration {

using Eigen::MatrixXd;

MatrixXd information_of(const readings::Readings& readings, const plant::MachineChain& chain,
                        const ErrorEffects& effects) {
  const Observations observations = observations_of(readings, chain);
  const auto m = static_cast<Eigen::Index>(observations.set_up.size());
  const Eigen::Index n = effects.size();
  MatrixXd A = MatrixXd::Zero(m + n, m + n);
  Eigen::RowVectorXd row(m + n);
  for (const Observation& one : observations.all) {
    row.setZero();
    for (const SetUpPart& part : one.set_up) row[Eigen::Index(part.unknown)] += part.factor;
    for (const Pose& pose : one.poses) row.tail(n) += effects.row(pose);
    const double sigma = readings.groups[one.group].uncertainty.value_or(1e-6);
    A.selfadjointView<Eigen::Lower>().rankUpdate(row.transpose(), 1.0 / (sigma * sigma));
  }
  A.triangularView<Eigen::StrictlyUpper>() = A.transpose().eval();
  for (Eigen::Index u = 0; u < m; ++u) {
    const auto& prior = observations.set_up[std::size_t(u)].prior;
    // what nothing is known of, and nothing depends on, must not make the matrix singular
    A(u, u) += prior ? 1.0 / (*prior * *prior) : 1e-10 * std::max(1.0, A(u, u));
  }
  if (m == 0) return A;
  const MatrixXd S = A.topLeftCorner(m, m), B = A.topRightCorner(m, n);
  return A.bottomRightCorner(n, n) - B.transpose() * numerics::solve_symmetric_columns(S, B);
}

}  // namespace servomill::sim::calibration

#include "sim/identification/identifiable_part.h"

#include <Eigen/Core>

#include "sim/numerics/decompositions.h"
#include "sim/numerics/dense_solver.h"

namespace servomill::sim::identification {
namespace {

constexpr double kNothing = 3e-3;  // singular value: what differences of a simulation resolve

// Columns of length 1, of the parameters that have an effect.
Eigen::MatrixXd unit_columns(const Eigen::MatrixXd& jacobian, IdentifiablePart& out) {
  for (Eigen::Index p = 0; p < jacobian.cols(); ++p) {
    if (jacobian.col(p).squaredNorm() > 0.0) out.parameters.push_back(static_cast<std::size_t>(p));
  }
  const auto count = static_cast<Eigen::Index>(out.parameters.size());
  out.norm.resize(count);
  Eigen::MatrixXd unit(jacobian.rows(), count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto column =
        jacobian.col(static_cast<Eigen::Index>(out.parameters[static_cast<std::size_t>(k)]));
    out.norm[k] = column.norm();
    unit.col(k) = column / out.norm[k];
  }
  return unit;
}

}  // namespace

IdentifiablePart identifiable_part(const Eigen::MatrixXd& jacobian) {
  IdentifiablePart out;
  const Eigen::MatrixXd unit = unit_columns(jacobian, out);
  if (out.parameters.empty()) return out;
  const Eigen::Index count = unit.cols();
  Eigen::MatrixXd R = Eigen::MatrixXd::Zero(count, count);  // zero below: fewer rows than columns
  R.topRows(std::min(unit.rows(), count)) = numerics::triangular_factor(unit);
  const numerics::SingularValues of_R = numerics::singular_values(R);  // unit = Q R has the same
  const Eigen::Index rank = of_R.rank(kNothing);
  const Eigen::MatrixXd along =
      of_R.V.leftCols(rank) * of_R.s.head(rank).cwiseInverse().asDiagonal();
  out.U = unit * along;
  out.back = out.norm.cwiseInverse().asDiagonal() * along;
  out.nothing = of_R.V.rightCols(count - rank);
  return out;
}

Eigen::VectorXd least_squares(const IdentifiablePart& part, const Eigen::VectorXd& residual,
                              Eigen::Index size) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(size);
  if (part.parameters.empty()) return out;
  const Eigen::VectorXd values = part.back * (part.U.transpose() * residual);
  for (std::size_t k = 0; k < part.parameters.size(); ++k) {
    out[static_cast<Eigen::Index>(part.parameters[k])] = values[static_cast<Eigen::Index>(k)];
  }
  return out;
}

}  // namespace servomill::sim::identification

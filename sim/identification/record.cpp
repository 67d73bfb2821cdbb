#include "sim/identification/record.h"

#include <algorithm>

#include "sim/numerics/dense_solver.h"

namespace servomill::sim::identification {

PossiblePositions possible_positions(const Record& record, bool has_loop) {
  constexpr double kAnywhere = 1e6;  // m, rad
  if (!has_loop) return {0.0, kAnywhere};
  constexpr double kShare = 100.0, kFloor = 0.1;  // m, rad
  double low = record.feedback.front(), high = low;
  for (const auto* list : {&record.command, &record.feedback}) {
    for (const double x : *list) {
      low = std::min(low, x);
      high = std::max(high, x);
    }
  }
  return {0.5 * (low + high), kShare * (high - low) + kFloor};
}

StartOfMotion start_of_motion(const Record& record) {
  constexpr std::size_t kSamples = 12;  // short beside any acceleration, long beside the quantum
  const std::size_t n = std::min(kSamples, record.size());
  if (n < 4) return {record.feedback.front(), 0.0};
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(n), 3);
  Eigen::VectorXd y(static_cast<Eigen::Index>(n));
  for (Eigen::Index k = 0; k < columns.rows(); ++k) {
    const double t = static_cast<double>(k);
    columns.row(k) << 1.0, t, t * t;
    y[k] = record.feedback[static_cast<std::size_t>(k)] - record.feedback.front();
  }
  const Eigen::Vector3d fit = numerics::least_squares(columns, y);
  return {record.feedback.front() + fit[0], fit[1] / record.period};
}

}  // namespace servomill::sim::identification

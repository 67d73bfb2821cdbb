/// Errors that set-ups determine, and those that none of them does in the available time.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/calibration/optimal_design.h"

namespace servomill::sim::calibration {

/// The unknowns in two parts that are independent by what is known of them: one that set-ups
/// determine, and one of which all of them together, each with the whole of the time, say less than
/// is known already.
///
///     M v = lambda P v,  V' P V = I    P: known information, M: that of all candidates
///
/// The second part is spanned by the v with lambda < 1.
struct Measurable {
  Eigen::MatrixXd projector;  // onto the first part (n x n)
  Eigen::MatrixXd beyond;     // root of the covariance of the second (n x m); m = 0: nothing
};

/// @param known  information before anything is taken (n x n), positive definite
/// @param time   s
Measurable measurable(const std::vector<Candidate>& candidates, const Eigen::MatrixXd& known,
                      double time);

}  // namespace servomill::sim::calibration

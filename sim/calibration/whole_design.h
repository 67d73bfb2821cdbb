/// Designs with whole counts: how often to take each candidate, by a search from a relaxed design.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/calibration/optimal_design.h"

namespace servomill::sim::calibration {

/// Whole counts within the time whose worst variance is small. Starts are the relaxed counts,
/// rounded down with and without stretching. Each is filled with what lowers the variances most for
/// its time; then some set-ups are taken out at random and the time is filled anew, which stays if
/// it gains (large neighbourhood search: Shaw, Using constraint programming and local search
/// methods to solve vehicle routing problems, CP 1998; for designs: Fedorov, Theory of Optimal
/// Experiments, 1972, exchanges). Random numbers have a fixed seed: the same problem has the same
/// plan.
/// @param relaxed  counts (one a candidate) that need not be whole
/// @pre there are candidates, each takes time; no quantity is without variance
std::vector<double> whole_counts(const std::vector<Candidate>& candidates,
                                 const Eigen::MatrixXd& known,
                                 const std::vector<Eigen::MatrixXd>& quantities,
                                 const std::vector<double>& relaxed, double time);

}  // namespace servomill::sim::calibration

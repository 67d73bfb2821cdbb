/// Optimal design of experiments: how often to take each of many candidate set-ups, so that the
/// worst uncertainty that matters is least for the time it takes.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace servomill::sim::calibration {

/// Information (n x n, positive semi-definite) that taking a candidate once gives on the unknowns,
/// its own set-up taken out, and the time of that.
struct Candidate {
  Eigen::MatrixXd information;
  double time = 1.0;  // s
};

/// Quantities whose variance counts: tr(K C K') of each, C the covariance of the unknowns.
struct Design {
  std::vector<double> counts;  // of each candidate
  double worst = 0.0;          // largest variance
  double bound = 0.0;          // no counts of the same time, whole or not, have a smaller one
  double efficiency() const { return worst > 0.0 ? bound / worst : 1.0; }
};

class DesignProblem {
 public:
  /// @param known  information before anything is taken (n x n); the sum with some candidates must
  ///               be positive definite
  DesignProblem(std::vector<Candidate> candidates, Eigen::MatrixXd known,
                std::vector<Eigen::MatrixXd> quantities);

  /// Variances of all quantities with these counts.
  std::vector<double> variances(const std::vector<double>& counts) const;

  /// Counts that need not be whole, by the multiplicative algorithm on a mean of high order of the
  /// variances; the bound follows from the convexity of each weighted sum of variances.
  /// Sources: Kiefer, Wolfowitz, The equivalence of two extremum problems, Canad. J. Math. 12
  /// (1960); Silvey, Titterington, Torsney, An algorithm for optimal designs on a design space,
  /// Comm. Stat. A7 (1978).
  Design relaxed(double time) const;

  /// Whole counts within the time (whole_design.h), and the bound of the relaxed design.
  Design whole(const Design& relaxed, double time) const;

 private:
  struct State;
  struct Gains {
    std::vector<double> each;  // variance gained a second on each candidate
    double steepest = 0.0;
    double bound = 0.0;
  };
  Gains gains_of(const State& state, double q, const std::vector<double>& counts,
                 double time) const;
  State state_of(const std::vector<double>& counts) const;
  double total_time(const std::vector<double>& counts) const;

  std::vector<Candidate> candidates_;
  Eigen::MatrixXd known_;
  std::vector<Eigen::MatrixXd> quantities_;
  Eigen::MatrixXd rows_;             // rows of all quantities, transposed: n x rows
  std::vector<Eigen::Index> first_;  // row of each quantity, and the end
};

}  // namespace servomill::sim::calibration

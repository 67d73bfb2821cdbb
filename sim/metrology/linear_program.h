/// Linear programs in a few variables and many constraints.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace servomill::sim {

/// a . x <= b
struct HalfSpace {
  Eigen::VectorXd a;
  double b = 0.0;
};

/// The x that makes cost . x smallest with a . x <= b for every half-space and |x_k| <= bound_k, or
/// nullopt if there is none.
///
/// Constraints are added one by one, in an order shuffled with a fixed seed; where one cuts the
/// best x off, the new best lies on its edge, which is the same problem with one variable less. In
/// d variables and n constraints that takes of the order of d! n steps.
/// @param cost, bound  (d), 1 <= d <= 6; bound > 0
/// @param constraints  each a (d), with components of the order of 1
/// Source: R. Seidel, Small-dimensional linear programming and convex hulls made easy, Discrete
/// Comput. Geom. 6 (1991), section 2.
std::optional<Eigen::VectorXd> minimize(const Eigen::VectorXd& cost, const Eigen::VectorXd& bound,
                                        std::vector<HalfSpace> constraints);

}  // namespace servomill::sim

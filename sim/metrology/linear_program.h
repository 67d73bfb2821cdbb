/// Linear programs in a few variables and many constraints.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace servomill::sim::metrology {

/// Vector of up to 6 numbers, which needs no memory of its own.
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 6, 1>;

/// a . x <= b
struct HalfSpace {
  SmallVector a;
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
std::optional<SmallVector> minimize(const SmallVector& cost, const SmallVector& bound,
                                    std::vector<HalfSpace> constraints);

}  // namespace servomill::sim::metrology

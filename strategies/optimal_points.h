/// Best positions of the points of a table, if the NC takes any positions but only so many of them.
///
/// As few candidates are chosen, the first and the last among them, that all are within a tolerance
/// of the chords; the tolerance is the least with which they are no more than allowed. A chord from
/// point i may end at j if its slope lies in the cone from i through the tolerances of all points
/// between, so that the fewest chords are a shortest way through those that may be drawn.
///
/// Source: H. Imai, M. Iri, "Computational-geometric methods for polygonal approximations of a
/// curve", Computer Vision, Graphics and Image Processing 36 (1986), 31-41; the cone: W. S. Chan,
/// F. Chin, "Approximation of polygonal curves with minimum number of line segments", ISAAC 1992.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace servomill::strategies {

/// @param x          (n >= 2), ascending (m)
/// @param value      (n) of X, Y, Z at x (m)
/// @param tolerance  largest deviation of each component from the chords (m)
/// @return numbers of the points, ascending, with the first and the last
std::vector<std::size_t> fewest_points(std::span<const double> x,
                                       std::span<const Eigen::Vector3d> value, double tolerance);

/// At most `most` points (at least 2) with the smallest largest deviation.
std::vector<std::size_t> optimal_points(std::span<const double> x,
                                        std::span<const Eigen::Vector3d> value, std::size_t most);

/// Largest deviation of a component from the chords between the points (m).
double largest_deviation(std::span<const double> x, std::span<const Eigen::Vector3d> value,
                         std::span<const std::size_t> points);

}  // namespace servomill::strategies

/// Common part of the least-squares fits of circles and spheres.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "sim/numerics/dense_solver.h"

namespace servomill::sim::metrology {

/// All points at one distance from a centre, in N dimensions.
template <int N>
struct Round {
  Eigen::Vector<double, N> centre = Eigen::Vector<double, N>::Zero();
  double radius = 0.0;
};

/// Least squares of 2 a . q + c = |q|^2 with q = p - mean: centre mean + a, radius sqrt(c + |a|^2).
/// @pre the points determine it
template <int N>
Round<N> algebraic_round(std::span<const Eigen::Vector<double, N>> points) {
  using Row = Eigen::Vector<double, N + 1>;
  Eigen::Vector<double, N> mean = Eigen::Vector<double, N>::Zero();
  for (const auto& p : points) mean += p;
  mean /= static_cast<double>(points.size());
  double size = 0.0;
  for (const auto& p : points) size = std::max(size, (p - mean).norm());
  Eigen::Matrix<double, N + 1, N + 1> normal = Eigen::Matrix<double, N + 1, N + 1>::Zero();
  Row right = Row::Zero();
  for (const auto& p : points) {
    const Eigen::Vector<double, N> q = (p - mean) / size;
    Row row;
    row << 2.0 * q, 1.0;
    normal += row * row.transpose();
    right += row * q.squaredNorm();
  }
  const Row x = numerics::solve_symmetric(normal, right);
  const Eigen::Vector<double, N> a = x.template head<N>();
  return {mean + size * a, size * std::sqrt(x[N] + a.squaredNorm())};
}

/// Least squares of | |p - centre| - radius |, by Gauss-Newton from the algebraic one.
/// @pre the points determine it
template <int N>
Round<N> geometric_round(std::span<const Eigen::Vector<double, N>> points) {
  constexpr int kMaxSteps = 50;     // about five are needed
  constexpr double kStill = 1e-14;  // of the radius: shorter steps are rounding
  using Row = Eigen::Vector<double, N + 1>;
  Round<N> round = algebraic_round<N>(points);
  for (int step = 0; step < kMaxSteps; ++step) {
    // |p - centre| - radius changes by -u . d(centre) - d(radius)
    Eigen::Matrix<double, N + 1, N + 1> normal = Eigen::Matrix<double, N + 1, N + 1>::Zero();
    Row right = Row::Zero();
    for (const auto& p : points) {
      const Eigen::Vector<double, N> d = p - round.centre;
      const double rho = d.norm();
      Row row;
      row << d / rho, 1.0;
      normal += row * row.transpose();
      right += row * (rho - round.radius);
    }
    const Row x = numerics::solve_symmetric(normal, right);
    round.centre += x.template head<N>();
    round.radius += x[N];
    if (x.norm() <= kStill * round.radius) break;
  }
  return round;
}

}  // namespace servomill::sim::metrology

#include "sim/metrology/points.h"

#include <cassert>

#include "sim/numerics/decompositions.h"

namespace servomill::sim::metrology {
namespace {

// Relative to the largest extent. Extents are roots of eigenvalues, exact to 1e-16 of the largest.
constexpr double kNoExtent = 1e-7;

template <int N>
PrincipalAxes<N> axes_of(std::span<const Eigen::Vector<double, N>> points) {
  assert(!points.empty());
  PrincipalAxes<N> out;
  const auto n = static_cast<double>(points.size());
  // about the first point, so that a far origin costs no digits
  for (const auto& p : points) out.mean += p - points.front();
  out.mean = points.front() + out.mean / n;
  Eigen::Matrix<double, N, N> covariance = Eigen::Matrix<double, N, N>::Zero();
  for (const auto& p : points) covariance += (p - out.mean) * (p - out.mean).transpose();
  const numerics::SymmetricEigen eigen = numerics::symmetric_eigen(covariance / n);
  out.axes = eigen.vectors.rowwise().reverse();
  out.extent = eigen.values.reverse().cwiseMax(0.0).cwiseSqrt();
  return out;
}

}  // namespace

template <int N>
bool PrincipalAxes<N>::span_directions(int count) const {
  assert(count >= 1 && count <= N);
  return extent[0] > 0.0 && extent[count - 1] > kNoExtent * extent[0];
}
template struct PrincipalAxes<2>;
template struct PrincipalAxes<3>;

PrincipalAxes<2> principal_axes(Points2 points) { return axes_of<2>(points); }
PrincipalAxes<3> principal_axes(Points3 points) { return axes_of<3>(points); }

Eigen::Vector3d across(const Eigen::Vector3d& unit) {
  Eigen::Index least = 0;
  unit.cwiseAbs().minCoeff(&least);
  return unit.cross(Eigen::Vector3d::Unit(least)).normalized();
}

}  // namespace servomill::sim::metrology

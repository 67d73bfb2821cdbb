#include "sim/metrology/cylinder_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "sim/metrology/round_fit.h"
#include "sim/numerics/decompositions.h"
#include "sim/numerics/dense_solver.h"

namespace servomill::sim::metrology {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Vector5 = Eigen::Vector<double, 5>;
using Matrix5 = Eigen::Matrix<double, 5, 5>;

constexpr int kMaxSteps = 200;        // ten or twenty are usual
constexpr double kLittleGain = 1e-4;  // of the sum: Gauss-Newton takes over
// Relative to the strongest motion: one that changes distances by less than 1e-7 of it is free.
constexpr double kFree = 1e-14;
constexpr int kDirections = 200;             // over the half-sphere, some 10 deg apart
constexpr int kStarts = 6;                   // of which the search begins
constexpr double kApart = 0.94;              // cosine: starts are 20 deg apart
constexpr std::size_t kPointsToStart = 300;  // enough to choose among starts

double sum_of_squares(Points3 points, const Cylinder& cylinder) {
  double sum = 0.0;
  for (const Vector3d& p : points) sum += std::pow(cylinder.distance(p), 2);
  return sum;
}

// Motions of a cylinder in its own frame, in units of its size: shift along u and v, slope of the
// axis towards u and v, radius.
struct LinearFit {
  Vector3d u, v;
  double size = 1.0;
  Matrix5 normal = Matrix5::Zero();
  Vector5 right = Vector5::Zero();

  LinearFit(Points3 points, const Cylinder& cylinder, double length)
      : u(across(cylinder.direction)), v(cylinder.direction.cross(u)), size(length) {
    for (const Vector3d& p : points) {
      const Vector3d d = p - cylinder.point;
      const Vector2d xy(u.dot(d), v.dot(d));
      const double rho = xy.norm();
      if (rho == 0.0) continue;  // on the axis: every way is the same
      Vector5 row;
      row << xy / rho, cylinder.direction.dot(d) / size * xy / rho, 1.0;
      normal += row * row.transpose();
      right += row * ((rho - cylinder.radius) / size);
    }
  }

  Vector5 step(double damping) const {
    Matrix5 damped = normal;
    damped.diagonal() *= 1.0 + damping;
    return numerics::solve_symmetric(damped, right);
  }

  Cylinder moved(const Cylinder& cylinder, const Vector5& x) const {
    return {cylinder.point + size * (x[0] * u + x[1] * v),
            (cylinder.direction + x[2] * u + x[3] * v).normalized(), cylinder.radius + size * x[4]};
  }

  bool determined() const {
    const Eigen::VectorXd strength = numerics::symmetric_eigen(normal).values;
    return strength[0] > kFree * strength[4];
  }
};

// Levenberg-Marquardt: downhill from anywhere, to where the sum hardly falls.
Cylinder descend(Points3 points, Cylinder cylinder, double size) {
  double sum = sum_of_squares(points, cylinder), damping = 1e-3;
  for (int step = 0; step < kMaxSteps; ++step) {
    const LinearFit fit(points, cylinder, size);
    const Cylinder next = fit.moved(cylinder, fit.step(damping));
    const double next_sum = sum_of_squares(points, next);
    if (next_sum < sum) {
      const bool little = next_sum > (1.0 - kLittleGain) * sum;
      cylinder = next;
      sum = next_sum;
      if (little && damping < 1e-6) break;
      damping *= 0.1;
    } else {
      if (damping > 1e6) break;
      damping *= 10.0;
    }
  }
  return cylinder;
}

// Gauss-Newton until rounding keeps the steps from getting shorter; nullopt where they never do.
std::optional<Cylinder> finish(Points3 points, Cylinder cylinder, double size) {
  constexpr double kSmall = 1e-9;  // a step below this that grows is rounding
  double last = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMaxSteps; ++step) {
    const LinearFit fit(points, cylinder, size);
    if (!fit.determined()) return std::nullopt;
    const Vector5 x = fit.step(0.0);
    const double length = x.norm();
    if (!std::isfinite(length)) return std::nullopt;
    if (length >= last && length < kSmall) return cylinder;
    last = length;
    cylinder = fit.moved(cylinder, x);
  }
  return std::nullopt;
}

Cylinder along(Points3 points, const Vector3d& direction, const Vector3d& mean) {
  const Vector3d u = across(direction), v = direction.cross(u);
  std::vector<Vector2d> feet;
  feet.reserve(points.size());
  for (const Vector3d& p : points) feet.emplace_back(u.dot(p - mean), v.dot(p - mean));
  const Round<2> round = algebraic_round<2>(feet);
  return {mean + round.centre.x() * u + round.centre.y() * v, direction, round.radius};
}

// Evenly over the half-sphere, on a spiral of golden angles.
std::vector<Vector3d> directions() {
  std::vector<Vector3d> out;
  for (int i = 0; i < kDirections; ++i) {
    const double z = (i + 0.5) / kDirections, r = std::sqrt(1.0 - z * z);
    const double angle = i * std::numbers::pi * (3.0 - std::sqrt(5.0));
    out.emplace_back(r * std::cos(angle), r * std::sin(angle), z);
  }
  return out;
}

std::vector<Vector3d> some_of(Points3 points) {
  const std::size_t stride = points.size() / kPointsToStart + 1;
  std::vector<Vector3d> out;
  for (std::size_t i = 0; i < points.size(); i += stride) out.push_back(points[i]);
  return out;
}

// The best of the directions, each the best within 20 deg.
std::vector<Cylinder> starts(Points3 points, const PrincipalAxes<3>& axes) {
  struct Start {
    Cylinder cylinder;
    double sum;
  };
  std::vector<Start> all;
  const auto add = [&](const Vector3d& direction) {
    const Cylinder cylinder = along(points, direction, axes.mean);
    const double sum = sum_of_squares(points, cylinder);
    if (std::isfinite(sum)) all.push_back({cylinder, sum});
  };
  for (int k = 0; k < 3; ++k) add(axes.axes.col(k));
  for (const Vector3d& direction : directions()) add(direction);
  std::stable_sort(all.begin(), all.end(),
                   [](const Start& a, const Start& b) { return a.sum < b.sum; });
  std::vector<Cylinder> out;
  for (const Start& start : all) {
    const bool taken = std::any_of(out.begin(), out.end(), [&](const Cylinder& c) {
      return std::abs(c.direction.dot(start.cylinder.direction)) > kApart;
    });
    if (!taken) out.push_back(start.cylinder);
    if (out.size() == kStarts) break;
  }
  return out;
}

std::optional<Cylinder> fit_from(Points3 points, const Cylinder& start,
                                 const PrincipalAxes<3>& axes) {
  auto cylinder = finish(points, descend(points, start, axes.extent[0]), axes.extent[0]);
  if (!cylinder) return std::nullopt;
  cylinder->point += cylinder->direction.dot(axes.mean - cylinder->point) * cylinder->direction;
  return cylinder;
}

}  // namespace

double Cylinder::distance(const Vector3d& p) const {
  return direction.cross(p - point).norm() - radius;
}

std::optional<Cylinder> least_squares_cylinder(Points3 points, const Vector3d& near) {
  if (points.size() < 5) return std::nullopt;
  const PrincipalAxes<3> axes = principal_axes(points);
  if (!axes.span_directions(3)) return std::nullopt;
  auto cylinder = fit_from(points, along(points, near.normalized(), axes.mean), axes);
  if (cylinder && cylinder->direction.dot(near) < 0.0) cylinder->direction *= -1.0;
  return cylinder;
}

std::optional<Cylinder> least_squares_cylinder(Points3 points) {
  if (points.size() < 5) return std::nullopt;
  const PrincipalAxes<3> axes = principal_axes(points);
  if (!axes.span_directions(3)) return std::nullopt;
  const std::vector<Vector3d> some = some_of(points);
  std::optional<Cylinder> best;
  double least = std::numeric_limits<double>::infinity();
  for (const Cylinder& start : starts(some, axes)) {
    const Cylinder cylinder = descend(some, start, axes.extent[0]);
    const double sum = sum_of_squares(some, cylinder);
    if (sum < least) {
      least = sum;
      best = cylinder;
    }
  }
  if (best) best = fit_from(points, *best, axes);
  if (!best) return std::nullopt;
  Eigen::Index largest = 0;
  best->direction.cwiseAbs().maxCoeff(&largest);
  if (best->direction[largest] < 0.0) best->direction *= -1.0;
  return best;
}

}  // namespace servomill::sim::metrology

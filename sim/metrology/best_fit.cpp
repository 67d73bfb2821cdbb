#include "sim/metrology/best_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/metrology/triangle_mesh.h"
#include "sim/numerics/decompositions.h"

namespace servomill::sim::metrology {
namespace {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Vector6 = Eigen::Vector<double, 6>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Columns3 = Eigen::Matrix<double, 3, Eigen::Dynamic>;
using Columns6 = Eigen::Matrix<double, 6, Eigen::Dynamic>;

constexpr int kMaxSteps = 200;    // Gauss-Newton takes about five, point to point some dozens
constexpr double kNoGain = 1e-9;  // of the sum of squares
// Likewise, while a motion is free: elsewhere it may not be, and great gains tell of a long way.
constexpr double kGainToGoOn = 0.01;
constexpr double kUnnoticed = 0.01;  // m/m, rms: weaker effects do not determine a motion
constexpr double kTiny = 1e-12;      // m: nearer than this a direction to the surface is rounding

// A nominal place for a moved point.
struct Target {
  Vector3d point, normal;  // the distance grows along the normal
  double distance = 0.0;
};
using Find = std::function<Target(std::size_t, const Vector3d&)>;

Vector3d mean_of(Points3 points) { return principal_axes(points).mean; }

std::vector<Vector3d> moved(Points3 points, const Isometry3d& motion) {
  std::vector<Vector3d> out;
  out.reserve(points.size());
  for (const Vector3d& p : points) out.push_back(motion * p);
  return out;
}

// Rows with leading ones, so that axes of coordinates come out as such.
Columns3 tidy(Columns3 basis) {
  Eigen::Index row = 0;
  for (Eigen::Index k = 0; k < basis.cols() && row < 3; ++row) {
    Eigen::Index largest = 0;
    if (basis.row(row).tail(basis.cols() - k).cwiseAbs().maxCoeff(&largest) < 1e-6) continue;
    basis.col(k).swap(basis.col(k + largest));
    basis.col(k) /= basis(row, k);
    for (Eigen::Index j = 0; j < basis.cols(); ++j) {
      if (j != k) basis.col(j) -= basis(row, j) * basis.col(k);
    }
    ++k;
  }
  basis.colwise().normalize();
  return basis;
}

std::string in_words(const Vector3d& v) {
  const auto number = [](double x) { return std::abs(x) < 5e-7 ? 0.0 : x; };
  return fmt::format("({:.4g}, {:.4g}, {:.4g})", number(v.x()), number(v.y()), number(v.z()));
}

// Free motions (shift, rotation about `centre` times `size`; columns, orthonormal) in words.
std::string free_motions(const Columns6& motions, const Vector3d& centre, double size) {
  const Columns3 rotations = motions.bottomRows(3);
  const numerics::SymmetricEigen eigen =
      numerics::symmetric_eigen(rotations.transpose() * rotations);
  const Eigen::Index turning = (eigen.values.array() > 0.01).count();
  const Columns6 sorted = motions * eigen.vectors.rowwise().reverse();  // those come first
  std::vector<std::string> words;
  const Columns3 shifts = tidy(sorted.topRows(3).rightCols(motions.cols() - turning));
  for (const auto& shift : shifts.colwise()) words.push_back("a shift along " + in_words(shift));
  for (Eigen::Index k = 0; k < turning; ++k) {
    const Vector3d rotation = sorted.bottomRows(3).col(k) / size, shift = sorted.topRows(3).col(k);
    const Vector3d through = centre + rotation.cross(shift) / rotation.squaredNorm();
    words.push_back(fmt::format("a rotation about {} through {} mm",
                                in_words(tidy(Columns3(rotation)).col(0)), in_words(through / mm)));
  }
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    out += (i == 0 ? "" : i + 1 == words.size() ? " and " : ", ") + words[i];
  }
  return out;
}

NoFit undetermined(const Columns6& motions, const Vector3d& centre, double size) {
  return {"the points do not determine the position of the part: it is insensitive to " +
          free_motions(motions, centre, size)};
}

// The least-squares rotation and shift between pairs of points.
Isometry3d closed_form(Points3 from, Points3 to) {
  const Vector3d mean_from = mean_of(from), mean_to = mean_of(to);
  Matrix3d covariance = Matrix3d::Zero();
  for (std::size_t i = 0; i < from.size(); ++i) {
    covariance += (to[i] - mean_to) * (from[i] - mean_from).transpose();
  }
  const numerics::SingularValues svd = numerics::singular_values(covariance);
  const Matrix3d U = svd.U, V = svd.V;
  Matrix3d no_mirror = Matrix3d::Identity();
  no_mirror(2, 2) = (U * V.transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  Isometry3d motion = Isometry3d::Identity();
  motion.linear() = U * no_mirror * V.transpose();
  motion.translation() = mean_to - motion.linear() * mean_from;
  return motion;
}

std::vector<Target> find_all(Points3 points, const Find& find) {
  std::vector<Target> out;
  out.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) out.push_back(find(i, points[i]));
  return out;
}

double sum_of_squares(const std::vector<Target>& targets) {
  double sum = 0.0;
  for (const Target& target : targets) sum += target.distance * target.distance;
  return sum;
}

// Distances as linear functions of a small motion about the mean of the points.
struct Linear {
  Vector3d centre;
  double size = 0.0;
  Matrix6 normal = Matrix6::Zero();
  Vector6 right = Vector6::Zero();

  Linear(Points3 points, const std::vector<Target>& targets, double count) {
    const PrincipalAxes<3> axes = principal_axes(points);
    centre = axes.mean;
    size = std::max(axes.extent.norm(), kTiny);
    for (std::size_t i = 0; i < points.size(); ++i) {
      Vector6 row;
      row << targets[i].normal, (points[i] - centre).cross(targets[i].normal) / size;
      normal += row * row.transpose() / count;
      right -= row * targets[i].distance / count;
    }
  }

  struct Step {
    Vector6 motion;  // Gauss-Newton, without what is free
    Columns6
        free;  // orthonormal motions that change distances by less than kUnnoticed of themselves
  };
  Step step() const {
    const numerics::SymmetricEigen eigen = numerics::symmetric_eigen(normal);
    Eigen::Index free = 0;
    for (const double value : eigen.values) free += value < kUnnoticed * kUnnoticed ? 1 : 0;
    const Columns6 noticed = eigen.vectors.rightCols(6 - free);
    const Eigen::VectorXd strength = eigen.values.tail(6 - free);
    const Eigen::VectorXd along = (noticed.transpose() * right).cwiseQuotient(strength);
    return {noticed * along, eigen.vectors.leftCols(free)};
  }

  Isometry3d motion(const Vector6& step) const {
    const Vector3d turn = step.tail<3>() / size;
    const double angle = turn.norm();
    Isometry3d out = Isometry3d::Identity();
    if (angle > 0.0) out.linear() = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
    out.translation() = centre + step.head<3>() - out.linear() * centre;
    return out;
  }
};

BestFit fit_of(const Isometry3d& motion, const std::vector<Target>& targets, int steps) {
  BestFit fit{motion, {}, 0.0, steps};
  for (const Target& target : targets) fit.distances.push_back(target.distance);
  fit.rms = std::sqrt(sum_of_squares(targets) / static_cast<double>(targets.size()));
  return fit;
}

std::variant<BestFit, NoFit> fit_to(Points3 measured, const Find& find, const Isometry3d& start) {
  if (measured.empty()) return NoFit{"there are no points"};
  const auto count = static_cast<double>(measured.size());
  Isometry3d motion = start;
  std::vector<Vector3d> points = moved(measured, motion);
  std::vector<Target> targets = find_all(points, find);
  double sum = sum_of_squares(targets), last_step = std::numeric_limits<double>::infinity();
  for (int steps = 1; steps <= kMaxSteps; ++steps) {
    throw_if_interrupted();
    const Linear linear(points, targets, count);
    const Linear::Step step = linear.step();
    const auto try_motion = [&](const Isometry3d& more, double limit) {
      Isometry3d next = more * motion;
      next.linear() = Eigen::Quaterniond(next.linear()).normalized().toRotationMatrix();
      std::vector<Vector3d> next_points = moved(measured, next);
      std::vector<Target> next_targets = find_all(next_points, find);
      const double next_sum = sum_of_squares(next_targets);
      if (!(next_sum < limit)) return false;
      motion = next;
      points = std::move(next_points);
      targets = std::move(next_targets);
      sum = next_sum;
      return true;
    };
    // near the end the sum is flat, and only the steps tell that they still lead somewhere
    const bool shorter = step.motion.norm() < 0.5 * last_step;
    last_step = step.motion.norm();
    if (try_motion(linear.motion(step.motion), sum * (shorter ? 1.0 + kNoGain : 1.0 - kNoGain))) {
      continue;
    }
    std::vector<Vector3d> nearest;
    for (const Target& target : targets) nearest.push_back(target.point);
    const double gain = step.free.cols() == 0 ? kNoGain : kGainToGoOn;
    if (try_motion(closed_form(points, nearest), sum * (1.0 - gain))) continue;
    if (step.free.cols() > 0) return undetermined(step.free, linear.centre, linear.size);
    return fit_of(motion, targets, steps);
  }
  return NoFit{fmt::format(
      "distances still decrease after {} steps; the points may be too far from the part",
      kMaxSteps)};
}

}  // namespace

std::variant<BestFit, NoFit> best_fit(Points3 measured, Points3 nominal) {
  assert(measured.size() == nominal.size());
  if (measured.empty()) return NoFit{"there are no points"};
  const PrincipalAxes<3> axes = principal_axes(nominal);
  if (!axes.span_directions(2) || !principal_axes(measured).span_directions(2)) {
    Columns6 free = Columns6::Zero(6, axes.span_directions(1) ? 1 : 3);
    free.bottomRows(3) = axes.axes.leftCols(free.cols());
    return undetermined(free, axes.mean, 1.0);
  }
  const Isometry3d motion = closed_form(measured, nominal);
  std::vector<Target> targets;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    targets.push_back({nominal[i], Vector3d::Zero(), (motion * measured[i] - nominal[i]).norm()});
  }
  return fit_of(motion, targets, 1);
}

std::variant<BestFit, NoFit> best_fit(Points3 measured, Points3 nominal, Points3 normals) {
  assert(measured.size() == nominal.size() && measured.size() == normals.size());
  return fit_to(
      measured,
      [&](std::size_t i, const Vector3d& p) {
        const double distance = normals[i].dot(p - nominal[i]);
        return Target{p - distance * normals[i], normals[i], distance};
      },
      Isometry3d::Identity());
}

std::variant<BestFit, NoFit> best_fit(Points3 measured, const TriangleMesh& nominal,
                                      const Isometry3d& start) {
  return fit_to(
      measured,
      [&](std::size_t, const Vector3d& p) {
        const SurfacePoint nearest = nominal.closest(p);
        // beside an edge the distance grows along the way from it
        const bool beside = !nearest.on_face && std::abs(nearest.distance) > kTiny;
        return Target{nearest.point,
                      beside ? Vector3d((p - nearest.point) / nearest.distance) : nearest.normal,
                      nearest.distance};
      },
      start);
}

std::vector<Arrow> quiver(Points3 measured, const Isometry3d& motion, const TriangleMesh& nominal) {
  std::vector<Arrow> arrows;
  for (const Vector3d& p : measured) {
    const SurfacePoint nearest = nominal.closest(motion * p);
    arrows.push_back({nearest.point, motion * p - nearest.point});
  }
  return arrows;
}

std::vector<Arrow> quiver(Points3 measured, const Isometry3d& motion, Points3 nominal,
                          Points3 normals) {
  assert(measured.size() == nominal.size() && measured.size() == normals.size());
  std::vector<Arrow> arrows;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    const double distance = normals[i].dot(motion * measured[i] - nominal[i]);
    arrows.push_back({nominal[i], distance * normals[i]});
  }
  return arrows;
}

}  // namespace servomill::sim::metrology

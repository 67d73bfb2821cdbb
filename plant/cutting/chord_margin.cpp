#include "plant/cutting/chord_margin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace servomill::plant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Matrix3d cross_matrix(const Vector3d& a) {
  Matrix3d A;
  A << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return A;
}

// The inverse of the smallest rotation from k_a to k_b.
Matrix3d turned_back(const Vector3d& k_a, const Vector3d& k_b) {
  const Matrix3d A = cross_matrix(k_a.cross(k_b));
  return Matrix3d::Identity() - A + A * A / (1.0 + k_a.dot(k_b));
}

double angle_between(const Vector3d& k_a, const Vector3d& k_b) {
  return std::atan2(k_a.cross(k_b).norm(), k_a.dot(k_b));
}

}  // namespace

CutterPosition between(const CutterPosition& a, const CutterPosition& b, double share) {
  const double angle = angle_between(a.axis, b.axis);
  return {a.tip + share * (b.tip - a.tip),
          ((std::sin((1.0 - share) * angle) * a.axis + std::sin(share * angle) * b.axis) /
           std::sin(angle))
              .normalized()};
}

double distance_from_chord(const CutterPosition* first, const CutterPosition* last,
                           const Envelope& body) {
  const double reach = body.reach();
  const Vector3d V = last->tip - first->tip, K = last->axis - first->axis;
  const double length = V.squaredNorm() + reach * reach * K.squaredNorm();
  const bool turns = std::any_of(
      first, last, [&](const CutterPosition& place) { return place.axis != last->axis; });
  if (turns && first->axis.dot(last->axis) <= 0.0) return kInfinity;
  const Matrix3d Q_last = turned_back(first->axis, last->axis);
  double most = 0.0, step_turn = 0.0, turn = 0.0;
  for (const CutterPosition* place = first + 1; place < last; ++place) {
    const Vector3d p = place->tip - first->tip;
    const double along = p.dot(V) + reach * reach * (place->axis - first->axis).dot(K);
    const double t = length > 0.0 ? std::clamp(along / length, 0.0, 1.0) : 0.0;
    if (!turns) {
      most = std::max(most, (p - t * V).norm());
      continue;
    }
    if (first->axis.dot(place->axis) <= 0.0) return kInfinity;
    const Matrix3d Q = turned_back(first->axis, place->axis);
    const Matrix3d turned = (1.0 - t) * Matrix3d::Identity() + t * Q_last - Q;
    const Vector3d moved = (1.0 - t) * p + t * (Q_last * (p - V));
    most = std::max(most, turned.norm() * reach + moved.norm());
    turn = std::max(turn, angle_between(first->axis, place->axis));
  }
  if (!turns) return most;
  // smallest rotations in a row are not the smallest from first to last: they differ by a spin
  // about the axis, the solid angle between the axes
  for (const CutterPosition* place = first; place < last; ++place) {
    step_turn = std::max(step_turn, angle_between(place->axis, (place + 1)->axis));
  }
  turn = std::max(turn, angle_between(first->axis, last->axis));
  return most + 0.7 * turn * step_turn * body.radius() + 2.0 * kTurnTolerance;
}

}  // namespace servomill::plant

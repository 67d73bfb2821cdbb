#include "sim/preparation/probed_face.h"

#include <algorithm>

namespace servomill::sim::preparation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kOnePlace = 10e-6;  // m

double likeness_of(const FacePoint& a, const FacePoint& b) {
  return std::max(a.normal.dot(b.normal), a.on_path.dot(b.on_path));
}

bool turns_with_path(const FacePoint& a, const FacePoint& b) {
  return a.on_path.dot(b.on_path) >= a.normal.dot(b.normal);
}

}  // namespace

FacePoint face_point(CutBy by, double s, double deviation, const Vector3d& normal,
                     const PathFrame& at) {
  FacePoint out{s, deviation, normal, {normal.dot(at.l), normal.dot(at.m)}};
  if (by == CutBy::flank) out.on_path[1] = 0.0;
  out.on_path.normalize();
  return out;
}

double ProbedFace::likeness(const FacePoint& point) const {
  return points_.empty() ? 1.0 : likeness_of(points_.back(), point);
}

void ProbedFace::add(const FacePoint& point) {
  if (points_.empty() || point.s - points_.back().s > kOnePlace) {
    points_.push_back(point);
    merged_ = 1.0;
    return;
  }
  merged_ += 1.0;
  points_.back().deviation += (point.deviation - points_.back().deviation) / merged_;
}

ProbedFace::At ProbedFace::at(double s, const PathFrame& frame, const Vector3d& axis) const {
  const auto behind =
      std::lower_bound(points_.begin(), points_.end(), s,
                       [](const FacePoint& one, double place) { return one.s < place; });
  const bool is_between = behind != points_.begin() && behind != points_.end();
  const FacePoint& a = behind == points_.begin() ? points_.front() : *(behind - 1);
  const FacePoint& b = is_between ? *behind : a;
  const double share = is_between ? (s - a.s) / (b.s - a.s) : 0.0;
  At out{axis, a.deviation + share * (b.deviation - a.deviation)};
  if (by_ == CutBy::tip) return out;
  if (is_between && turns_with_path(a, b)) {
    const Vector2d on_path = a.on_path + share * (b.on_path - a.on_path);
    out.normal = (on_path[0] * frame.l + on_path[1] * frame.m).normalized();
  } else {
    out.normal = (a.normal + share * (b.normal - a.normal)).normalized();
  }
  return out;
}

}  // namespace servomill::sim::preparation

#include "sim/metrology/minimum_zone.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "sim/metrology/zone_search.h"

namespace servomill::sim::metrology {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// In widths: largest change of a tilt or slope in one step.
constexpr double kReach = 10.0;

// Twice the area of a triangle: positive if it turns left.
double turn_left(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

// Corners of the convex hull, counter-clockwise, without those within its edges (A. M. Andrew's
// monotone chain: the lower half from left to right, the upper half back).
std::vector<Vector2d> convex_hull(std::vector<Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const Vector2d& a, const Vector2d& b) {
    return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y();
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 2) return points;
  std::vector<Vector2d> hull;
  for (int half = 0; half < 2; ++half) {
    const std::size_t first = hull.size();
    for (const Vector2d& p : points) {
      while (hull.size() >= first + 2 && turn_left(hull[hull.size() - 2], hull.back(), p) <= 0.0) {
        hull.pop_back();
      }
      hull.push_back(p);
    }
    hull.pop_back();  // the other half begins with it
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

// A plane through the mean that tilts.
class PlaneZone : public ZoneShape {
 public:
  PlaneZone(Points3 points, const Plane& start)
      : points_(points), now_(start), axes_(principal_axes(points)) {
    for (const Vector3d& p : points) {
      const Eigen::Array3d q = (axes_.axes.transpose() * (p - axes_.mean)).array().abs();
      half_ = half_.max(q.head<2>());
    }
    now_.point = axes_.mean;
  }
  std::size_t points() const override { return points_.size(); }
  double distance(std::size_t i) const override { return now_.distance(points_[i]); }
  SmallVector gradient(std::size_t i) const override {
    const Vector3d q = points_[i] - now_.point;
    return Vector2d(axes_.axes.col(0).dot(q) / half_[0], axes_.axes.col(1).dot(q) / half_[1]);
  }
  void move(const SmallVector& x) override {
    now_.normal += x[0] / half_[0] * axes_.axes.col(0) + x[1] / half_[1] * axes_.axes.col(1);
    now_.normal.normalize();
  }
  void keep() override { kept_ = now_; }
  std::size_t cells() const override { return kCells * kCells; }
  std::size_t cell(std::size_t i) const override {
    const SmallVector at = gradient(i);  // -1 ... 1
    const auto row = [&](Eigen::Index k) {
      return std::min(static_cast<std::size_t>(std::max(0.0, 0.5 * (at[k] + 1.0) * kCells)),
                      kCells - 1);
    };
    return row(0) * kCells + row(1);
  }
  double size() const override { return half_[0]; }
  double reach() const override { return kReach; }
  const Plane& plane() const { return kept_; }

 private:
  static constexpr std::size_t kCells = 4;  // along each direction

  Points3 points_;
  Plane now_, kept_;
  PrincipalAxes<3> axes_;
  Eigen::Array2d half_ = Eigen::Array2d::Zero();  // extents on both sides of the mean
};

// A cylinder whose axis shifts and leans.
class CylinderZone : public ZoneShape {
 public:
  CylinderZone(Points3 points, const Cylinder& start) : points_(points), now_(start) {
    for (const Vector3d& p : points) half_ = std::max(half_, std::abs(along(p)));
    turn();
  }
  std::size_t points() const override { return points_.size(); }
  double distance(std::size_t i) const override { return now_.distance(points_[i]); }
  SmallVector gradient(std::size_t i) const override {
    const Vector2d out = across_axis(points_[i]).normalized();
    const double z = along(points_[i]) / half_;
    return Eigen::Vector4d(-out.x(), -out.y(), -z * out.x(), -z * out.y());
  }
  void move(const SmallVector& x) override {
    now_.point += x[0] * u_ + x[1] * v_;
    now_.direction += x[2] / half_ * u_ + x[3] / half_ * v_;
    now_.direction.normalize();
    turn();
  }
  void keep() override { kept_ = now_; }
  std::size_t cells() const override { return kSectors * kSections; }
  std::size_t cell(std::size_t i) const override {
    const Vector2d d = across_axis(points_[i]);
    const auto part = [](double share, std::size_t of) {
      return std::min(static_cast<std::size_t>(std::max(0.0, share * static_cast<double>(of))),
                      of - 1);
    };
    return part(0.5 + 0.5 * std::atan2(d.y(), d.x()) / std::numbers::pi, kSectors) * kSections +
           part(0.5 + 0.5 * along(points_[i]) / half_, kSections);
  }
  double size() const override { return now_.radius; }
  double reach() const override { return kReach; }
  const Cylinder& cylinder() const { return kept_; }

 private:
  static constexpr std::size_t kSectors = 8, kSections = 3;

  double along(const Vector3d& p) const { return now_.direction.dot(p - now_.point); }
  Vector2d across_axis(const Vector3d& p) const {
    return {u_.dot(p - now_.point), v_.dot(p - now_.point)};
  }
  void turn() {
    u_ = across(now_.direction);
    v_ = now_.direction.cross(u_);
  }

  Points3 points_;
  Cylinder now_, kept_;
  Vector3d u_, v_;
  double half_ = 0.0;  // length on both sides of the point
};

}  // namespace

std::optional<Zone<Line2>> minimum_zone_line(Points2 points) {
  if (points.empty()) return std::nullopt;
  // about the first point, so that a far origin costs no digits
  std::vector<Vector2d> shifted;
  shifted.reserve(points.size());
  for (const Vector2d& p : points) shifted.push_back(p - points.front());
  const std::vector<Vector2d> hull = convex_hull(std::move(shifted));
  if (hull.size() < 2) return std::nullopt;

  Zone<Line2> best{{}, std::numeric_limits<double>::infinity()};
  std::size_t far = 1;  // the corner farthest from the edge; it goes around once as the edge does
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const Line2 edge{hull[i], (hull[(i + 1) % hull.size()] - hull[i]).normalized()};
    const auto height = [&](std::size_t k) { return edge.distance(hull[k % hull.size()]); };
    if (far <= i) far = i + 1;
    while (height(far + 1) > height(far)) ++far;
    if (height(far) < best.width) best = {edge, height(far)};
  }
  const Vector2d left(-best.middle.direction.y(), best.middle.direction.x());
  best.middle.point += points.front() + 0.5 * best.width * left;
  if (best.middle.direction.dot(points.back() - points.front()) < 0.0)
    best.middle.direction *= -1.0;
  return best;
}

std::optional<Zone<Plane>> minimum_zone_plane(Points3 points, const Vector3d& outside) {
  const auto start = least_squares_plane(points, outside);
  if (!start) return std::nullopt;
  PlaneZone zone(points, *start);
  narrow_zone(zone);
  Plane plane = zone.plane();
  const Spread spread = spread_about(points, plane);
  plane.point += 0.5 * (spread.low + spread.high) * plane.normal;
  return Zone<Plane>{plane, spread.range()};
}

std::optional<Zone<Cylinder>> minimum_zone_cylinder(Points3 points, const Vector3d& near) {
  const auto start = least_squares_cylinder(points, near);
  if (!start) return std::nullopt;
  CylinderZone zone(points, *start);
  narrow_zone(zone);
  Cylinder cylinder = zone.cylinder();
  const Spread spread = spread_about(points, cylinder);
  cylinder.radius += 0.5 * (spread.low + spread.high);
  return Zone<Cylinder>{cylinder, spread.range()};
}

}  // namespace servomill::sim::metrology

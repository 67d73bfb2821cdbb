#include "sim/metrology/circle_fit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "sim/metrology/round_fit.h"
#include "sim/metrology/zone_search.h"

namespace servomill::sim::metrology {
namespace {

using Eigen::Vector2d;

constexpr std::size_t kSectors = 16;

// Circles about a centre that moves.
class CircleZone : public ZoneShape {
 public:
  CircleZone(Points2 points, const Circle& start)
      : points_(points), centre_(start.centre), radius_(start.radius) {}
  std::size_t points() const override { return points_.size(); }
  double distance(std::size_t i) const override { return (points_[i] - centre_).norm(); }
  SmallVector gradient(std::size_t i) const override {
    return -(points_[i] - centre_).normalized();
  }
  void move(const SmallVector& motions) override { centre_ += motions; }
  void keep() override { kept_ = centre_; }
  std::size_t cells() const override { return kSectors; }
  std::size_t cell(std::size_t i) const override {
    const Vector2d d = points_[i] - centre_;
    const double turn = 0.5 + 0.5 * std::atan2(d.y(), d.x()) / std::numbers::pi;  // 0 ... 1
    return std::min(static_cast<std::size_t>(turn * static_cast<double>(kSectors)), kSectors - 1);
  }
  double size() const override { return radius_; }
  // a shift by a zone's width widens it to at least that; so the best one is shorter
  double reach() const override { return 1.0; }
  Vector2d centre() const { return kept_; }

 private:
  Points2 points_;
  Vector2d centre_, kept_;
  double radius_;
};

}  // namespace

Circle least_squares_circle(Points2 points) {
  assert(points.size() >= 3);
  const Round<2> round = geometric_round<2>(points);
  return {round.centre, round.radius};
}

RingZone zone_about(Points2 points, const Vector2d& centre) {
  assert(!points.empty());
  RingZone zone{centre, (points.front() - centre).norm(), 0.0};
  for (const Vector2d& p : points) {
    const double rho = (p - centre).norm();
    zone.inner = std::min(zone.inner, rho);
    zone.outer = std::max(zone.outer, rho);
  }
  return zone;
}

RingZone minimum_zone(Points2 points) {
  CircleZone zone(points, least_squares_circle(points));
  narrow_zone(zone);
  return zone_about(points, zone.centre());
}

}  // namespace servomill::sim::metrology

#include "sim/metrology/circle_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include "sim/metrology/linear_program.h"
#include "sim/metrology/round_fit.h"

namespace servomill::sim {
namespace {

using Eigen::Vector2d;

constexpr int kMostSteps = 50;        // about five are needed
constexpr double kStill = 1e-14;      // of the radius: shorter steps are rounding
constexpr double kNoGain = 1e-12;     // of the zone's width
constexpr std::size_t kSectors = 16;  // that the minimum zone begins with

// Points that the zone must hold, and how to find those that stick out.
class ZoneSearch {
 public:
  ZoneSearch(Points2 points, const Vector2d& centre) : points_(points), centre_(centre) {
    take_extremes_of_sectors();
  }

  // Moves the centre to where the zone of the chosen points is narrowest.
  void improve() {
    const RingZone now = chosen_zone();
    const double width = std::max(now.width(), kStill * now.outer);
    const double middle = 0.5 * (now.inner + now.outer);
    // x = (shift of the centre, outer and inner radius beyond the middle), in units of the width:
    // outer >= rho - u . shift, inner <= rho - u . shift
    std::vector<HalfSpace> constraints;
    for (const std::size_t i : chosen_) {
      const Vector2d d = points_[i] - centre_;
      const double rho = (d.norm() - middle) / width;
      const Vector2d u = d.normalized();
      constraints.push_back({Eigen::Vector4d(-u.x(), -u.y(), -1.0, 0.0), -rho});
      constraints.push_back({Eigen::Vector4d(u.x(), u.y(), 0.0, 1.0), rho});
    }
    // a shift by a zone's width widens it to at least that; so the best one is shorter
    const auto x = minimize(Eigen::Vector4d(0.0, 0.0, 1.0, -1.0),
                            Eigen::Vector4d(1.0, 1.0, 4.0, 4.0), std::move(constraints));
    assert(x && "radii of the size of the zone always do");
    if (x) centre_ += width * x->head<2>();
  }

  // Adds the points of all that stick out farthest; false if none does.
  bool take_what_sticks_out() {
    const std::size_t before = chosen_.size();
    const RingZone zone = chosen_zone();
    const auto [inner, outer] = extremes();
    if (distance(outer) > zone.outer) chosen_.push_back(outer);
    if (distance(inner) < zone.inner) chosen_.push_back(inner);
    return chosen_.size() > before;
  }

  RingZone zone() const { return zone_about(points_, centre_); }

 private:
  double distance(std::size_t i) const { return (points_[i] - centre_).norm(); }

  RingZone chosen_zone() const {
    RingZone zone{centre_, distance(chosen_.front()), 0.0};
    for (const std::size_t i : chosen_) {
      zone.inner = std::min(zone.inner, distance(i));
      zone.outer = std::max(zone.outer, distance(i));
    }
    return zone;
  }

  std::pair<std::size_t, std::size_t> extremes() const {
    std::size_t inner = 0, outer = 0;
    for (std::size_t i = 1; i < points_.size(); ++i) {
      if (distance(i) < distance(inner)) inner = i;
      if (distance(i) > distance(outer)) outer = i;
    }
    return {inner, outer};
  }

  // The innermost and the outermost point of each sector: a good first choice, all around.
  void take_extremes_of_sectors() {
    constexpr std::size_t kNobody = static_cast<std::size_t>(-1);
    std::array<std::size_t, kSectors> inner, outer;
    inner.fill(kNobody);
    outer.fill(kNobody);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Vector2d d = points_[i] - centre_;
      const double turn = 0.5 + 0.5 * std::atan2(d.y(), d.x()) / std::numbers::pi;  // 0 ... 1
      const std::size_t k =
          std::min(static_cast<std::size_t>(turn * static_cast<double>(kSectors)), kSectors - 1);
      if (inner[k] == kNobody || distance(i) < distance(inner[k])) inner[k] = i;
      if (outer[k] == kNobody || distance(i) > distance(outer[k])) outer[k] = i;
    }
    for (std::size_t k = 0; k < kSectors; ++k) {
      if (inner[k] != kNobody) chosen_.push_back(inner[k]);
      if (outer[k] != inner[k]) chosen_.push_back(outer[k]);
    }
  }

  Points2 points_;
  Vector2d centre_;
  std::vector<std::size_t> chosen_;
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
  const Circle start = least_squares_circle(points);
  ZoneSearch search(points, start.centre);
  RingZone best = search.zone();
  for (int step = 0; step < kMostSteps; ++step) {
    search.improve();
    const RingZone zone = search.zone();
    const bool better = zone.width() < best.width() * (1.0 - kNoGain);
    if (zone.width() < best.width()) best = zone;
    if (!search.take_what_sticks_out() && !better) break;
  }
  return best;
}

}  // namespace servomill::sim

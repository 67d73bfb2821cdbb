#include "sim/metrology/zone_search.h"

#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

namespace servomill::sim::metrology {
namespace {

constexpr int kMaxSteps = 500;     // about five are needed, more where many points nearly touch
constexpr double kStill = 1e-14;   // of the size: narrower zones are rounding
constexpr double kNoGain = 1e-12;  // of the zone's width

// The points of least and of greatest distance.
std::pair<std::size_t, std::size_t> extremes(const ZoneShape& shape) {
  std::size_t inner = 0, outer = 0;
  double low = shape.distance(0), high = low;
  for (std::size_t i = 1; i < shape.points(); ++i) {
    const double distance = shape.distance(i);
    if (distance < low) {
      low = distance;
      inner = i;
    }
    if (distance > high) {
      high = distance;
      outer = i;
    }
  }
  return {inner, outer};
}

class ZoneSearch {
 public:
  explicit ZoneSearch(ZoneShape& shape) : shape_(shape) { take_extremes_of_cells(); }

  // Moves the shape to where the zone of the chosen points is narrowest.
  void improve() {
    const Spread now = chosen_spread();
    const double width = std::max(now.range(), kStill * shape_.size());
    const double middle = 0.5 * (now.low + now.high);
    // x = (motions, outer and inner limit beyond the middle), in units of the width:
    // outer >= rho + gradient . motions, inner <= rho + gradient . motions
    const Eigen::Index d = shape_.gradient(0).size();
    std::vector<HalfSpace> constraints;
    for (const std::size_t i : chosen_) {
      const double rho = (shape_.distance(i) - middle) / width;
      const SmallVector gradient = shape_.gradient(i);
      SmallVector outer(d + 2), inner(d + 2);
      outer << gradient, -1.0, 0.0;
      inner << -gradient, 0.0, 1.0;
      constraints.push_back({outer, -rho});
      constraints.push_back({inner, rho});
    }
    SmallVector cost = SmallVector::Zero(d + 2),
                bound = SmallVector::Constant(d + 2, shape_.reach());
    cost.tail<2>() = Eigen::Vector2d(1.0, -1.0);
    bound.tail<2>() *= 4.0;
    const auto x = minimize(cost, bound, std::move(constraints));
    assert(x && "limits of the size of the zone always do");
    if (x) shape_.move(width * x->head(d));
  }

  // Adds the points of all that stick out farthest; false if none does.
  bool take_what_sticks_out() {
    const std::size_t before = chosen_.size();
    const Spread zone = chosen_spread();
    const auto [inner, outer] = extremes(shape_);
    if (shape_.distance(outer) > zone.high) chosen_.push_back(outer);
    if (shape_.distance(inner) < zone.low) chosen_.push_back(inner);
    return chosen_.size() > before;
  }

 private:
  Spread chosen_spread() const {
    Spread zone{shape_.distance(chosen_.front()), 0.0};
    zone.high = zone.low;
    for (const std::size_t i : chosen_) {
      zone.low = std::min(zone.low, shape_.distance(i));
      zone.high = std::max(zone.high, shape_.distance(i));
    }
    return zone;
  }

  // The innermost and the outermost point of each cell: a good first choice, all over the shape.
  void take_extremes_of_cells() {
    constexpr std::size_t kNobody = static_cast<std::size_t>(-1);
    std::vector<std::size_t> inner(shape_.cells(), kNobody), outer(shape_.cells(), kNobody);
    for (std::size_t i = 0; i < shape_.points(); ++i) {
      const std::size_t k = shape_.cell(i);
      const double distance = shape_.distance(i);
      if (inner[k] == kNobody || distance < shape_.distance(inner[k])) inner[k] = i;
      if (outer[k] == kNobody || distance > shape_.distance(outer[k])) outer[k] = i;
    }
    for (std::size_t k = 0; k < shape_.cells(); ++k) {
      if (inner[k] != kNobody) chosen_.push_back(inner[k]);
      if (outer[k] != inner[k]) chosen_.push_back(outer[k]);
    }
  }

  ZoneShape& shape_;
  std::vector<std::size_t> chosen_;
};

}  // namespace

Spread ZoneShape::spread() const {
  const auto [inner, outer] = extremes(*this);
  return {distance(inner), distance(outer)};
}

void narrow_zone(ZoneShape& shape) {
  ZoneSearch search(shape);
  double best = shape.spread().range();
  shape.keep();
  for (int step = 0; step < kMaxSteps; ++step) {
    search.improve();
    const double width = shape.spread().range();
    const bool better = width < best * (1.0 - kNoGain);
    if (width < best) {
      best = width;
      shape.keep();
    }
    if (!search.take_what_sticks_out() && !better) break;
  }
}

}  // namespace servomill::sim::metrology

#include "strategies/traced_path.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace servomill::strategies {

TracedPath::TracedPath(std::size_t length) : points_(std::max<std::size_t>(2, length)) {}

void TracedPath::start(const Eigen::Vector3d& p) {
  oldest_ = near_ = 0;
  count_ = 1;
  points_[0] = {p, 0.0};
}

void TracedPath::add(const Eigen::Vector3d& p) {
  const Point& last = point(count_ - 1);
  const double step = (p - last.p).norm();
  if (step < kShortest) return;
  const Point next{p, last.length + step};
  if (count_ < points_.size()) {
    points_[(oldest_ + count_++) % points_.size()] = next;
    return;
  }
  points_[oldest_] = next;
  oldest_ = (oldest_ + 1) % points_.size();
  if (near_ > 0) --near_;
}

TracedPath::Foot TracedPath::foot(std::size_t chord, const Eigen::Vector3d& a) const {
  const Eigen::Vector3d from = point(chord).p, along = point(chord + 1).p - from;
  const double t = std::clamp((a - from).dot(along) / along.squaredNorm(), 0.0, 1.0);
  return {t, (from + t * along - a).squaredNorm()};
}

// A chord later on the path is nearer than d only if the path to it is longer than D - d, D the
// distance of an earlier one.
void TracedPath::look_ahead(const Eigen::Vector3d& a, Foot& now) {
  const std::size_t last = count_ - 2;
  for (std::size_t n = near_ + 1; n <= last;) {
    const Foot there = foot(n, a);
    if (there.square <= now.square) {
      near_ = n;
      now = there;
    }
    const double length = point(n).length + std::sqrt(there.square) - std::sqrt(now.square);
    ++n;
    while (n <= last && point(n + 1).length < length) ++n;
  }
}

TracedPath::Place TracedPath::nearest(const Eigen::Vector3d& a) {
  assert(has_moved());
  const std::size_t last = count_ - 2;
  near_ = std::min(near_, last);
  Foot now = foot(near_, a);
  while (near_ > 0) {
    const Foot before = foot(near_ - 1, a);
    if (before.square >= now.square) break;
    --near_;
    now = before;
  }
  look_ahead(a, now);
  const Eigen::Vector3d from = point(near_).p, along = point(near_ + 1).p - from;
  const Eigen::Vector3d tangent = along.normalized();
  const bool is_before = near_ == 0 && now.t == 0.0, is_after = near_ == last && now.t == 1.0;
  if (is_before || is_after) return {from + tangent.dot(a - from) * tangent, tangent};
  return {from + now.t * along, tangent};
}

}  // namespace servomill::strategies

#include "controllers/path/smoothing_windows.h"

#include <Eigen/Core>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "plant/vocabulary/interrupt.h"

namespace servomill::controllers {
namespace {

constexpr std::size_t kMaxReach = 64;  // vertices on either side that a window may cover
constexpr double kArcMargin = 0.9;     // of the tolerance: room for moving arc points outward
constexpr double kFits = 1e-9;         // rounding of the deviation, of the tolerance
constexpr double kShrink = 0.85;       // step of the search for a window
constexpr int kArcPasses = 3;          // each leaves (w/R)^2 of the error before

double linear_norm(const Joints& u) { return u.head<kLinearJoints>().norm(); }
double rotary_norm(const Joints& u) { return u.tail<kJoints - kLinearJoints>().norm(); }

}  // namespace

SmoothingWindows::SmoothingWindows(Polyline vertices) : v_(std::move(vertices)), n_(v_.size() - 1) {
  for (std::size_t i = 0; v_.has_arcs() && i < v_.size(); ++i) target_.push_back(v_.u(i));
  measure();
}

void SmoothingWindows::choose() {
  const bool arcs = v_.has_arcs();
  const double share = arcs ? kArcMargin : 1.0;
  choose_each(share);
  fit(share);
  if (!arcs) return;
  for (int pass = 0; pass < kArcPasses; ++pass) pull_arcs_outward();
  fit(1.0);
}

void SmoothingWindows::measure() {
  s_.assign(n_ + 1, 0.0);
  dd_.assign(n_ + 1, Joints::Zero());
  Joints before = Joints::Zero();
  for (std::size_t k = 0; k < n_; ++k) {
    const Joints chord = v_.u(k + 1) - v_.u(k);
    const double length = chord.norm();
    assert(length > 0.0);
    s_[k + 1] = s_[k] + length;
    const Joints d = chord / length;
    if (k > 0) dd_[k] = d - before;
    before = d;
  }
}

Joints SmoothingWindows::direction(std::size_t k) const {
  const Joints chord = v_.u(k + 1) - v_.u(k);
  const double length = chord.norm();
  return chord / length;
}

PathState SmoothingWindows::state_at(double s, std::size_t chord) const {
  const std::size_t k = std::min(chord, n_ - 1);
  std::size_t first = k + 1, last = k + 1;
  while (first > 1 && s_[first - 1] + w_[first - 1] > s) --first;
  while (last < n_ && s_[last] - w_[last] < s) ++last;
  // at the end of the chord it is the state before the vertex there, whose direction is that of
  // this chord
  const Deviation D = deviation(s, std::min(s, std::nextafter(s_[k + 1], s_[k])), first, last);
  const Joints d = direction(k);
  return {v_.u(k) + d * (s - s_[k]) + D.d0, d + D.d1, D.d2};
}

CubicPiece SmoothingWindows::piece(const Span& span, double from) const {
  const Deviation D = deviation(from, span.middle(), span.first, span.last);
  const std::size_t k = span.segment;
  const Joints d = direction(k);
  return {from, v_.u(k) + d * (from - s_[k]) + D.d0, d + D.d1, D.d2, D.d3, k};
}

// Deviation at vertex i if it and its neighbours all had the window w.
Joints SmoothingWindows::deviation_with(std::size_t i, double w) const {
  Joints sum = Joints::Zero();
  const auto add = [&](std::size_t k) {
    const double y = w - std::abs(s_[k] - s_[i]);
    if (y <= 0.0) return false;
    sum += dd_[k] * (y * y * y);
    return true;
  };
  for (std::size_t k = i; k < n_ && add(k);) ++k;
  for (std::size_t k = i; k > 1 && add(k - 1);) --k;
  return sum / (6.0 * w * w);
}

// Widest window of each vertex on its own, from wide to narrow.
void SmoothingWindows::choose_each(double share) {
  w_.assign(n_ + 1, 0.0);
  double widest_before = 0.0;
  for (std::size_t i = 1; i < n_; ++i) {
    const double tol_linear =
        share * std::min(v_.traits(i).tolerance_linear, v_.traits(i + 1).tolerance_linear);
    const double tol_rotary =
        share * std::min(v_.traits(i).tolerance_rotary, v_.traits(i + 1).tolerance_rotary);
    double w = std::min(s_[i], s_[n_] - s_[i]);
    w = std::min(w, 6.0 * tol_linear / std::max(linear_norm(dd_[i]), 1e-30));
    w = std::min(w, 6.0 * tol_rotary / std::max(rotary_norm(dd_[i]), 1e-30));
    if (i > kMaxReach) w = std::min(w, s_[i] - s_[i - kMaxReach]);
    if (i + kMaxReach < n_) w = std::min(w, s_[i + kMaxReach] - s_[i]);
    const double alone = std::min(w, std::min(s_[i] - s_[i - 1], s_[i + 1] - s_[i]));
    // limit_slope would cut what is wider than that
    const double most = std::min(w_[i - 1], widest_before) + (s_[i] - s_[i - 1]);
    while (w * kShrink >= std::max(most, alone)) w *= kShrink;
    while (w > alone) {
      const Joints D = deviation_with(i, w);
      if (linear_norm(D) <= tol_linear && rotary_norm(D) <= tol_rotary) break;
      w *= kShrink;
    }
    w_[i] = std::max(w, alone);
    widest_before = most;
  }
  limit_slope();
}

void SmoothingWindows::limit_slope() {
  for (std::size_t i = 1; i <= n_; ++i) w_[i] = std::min(w_[i], w_[i - 1] + (s_[i] - s_[i - 1]));
  for (std::size_t i = n_; i-- > 0;) w_[i] = std::min(w_[i], w_[i + 1] + (s_[i + 1] - s_[i]));
  w_[n_] = 0.0;
}

SmoothingWindows::Deviation SmoothingWindows::deviation(double x, double middle, std::size_t first,
                                                        std::size_t last) const {
  Deviation D;
  for (std::size_t i = first; i < last; ++i) {
    const double w = w_[i];
    if (std::abs(middle - s_[i]) >= w) continue;
    const double side = middle < s_[i] ? 1.0 : -1.0;
    const double y = std::max(w + side * (x - s_[i]), 0.0), K = 1.0 / (w * w);
    D.d0 += dd_[i] * (K * y * y * y / 6.0);
    D.d1 += dd_[i] * (side * K * y * y / 2.0);
    D.d2 += dd_[i] * (K * y);
    D.d3 += dd_[i] * (side * K);
  }
  return D;
}

// Deviation (2) on one span after the other. Between knots it is a cubic; a knot changes its
// third derivative by the curvature of one window, so that the sum over all of them is rarely
// needed.
class SmoothingWindows::RollingDeviation {
 public:
  explicit RollingDeviation(const SmoothingWindows& path) : path_(path) {}

  /// At the begin of the span.
  const Deviation& at(const Span& span) {
    if (!roll(span)) {
      D_ = path_.deviation(span.from, span.middle(), span.first, span.last);
      anchor_ = span.from;
      narrowest_ = std::numeric_limits<double>::infinity();
      steps_ = 0;
    }
    last_ = span;
    return D_;
  }

 private:
  // Rounding of the third derivative, eps/w^2 for each window, grows like the cube of the way.
  static constexpr int kMaxSteps = 32;
  static constexpr double kMaxWindows = 16.0;

  bool roll(const Span& span) {
    if (++steps_ > kMaxSteps || span.from != last_.to) return false;
    const double h = span.from - last_.from;
    D_.d0 += h * (D_.d1 + (0.5 * h) * (D_.d2 + (h / 3.0) * D_.d3));
    D_.d1 += h * (D_.d2 + (0.5 * h) * D_.d3);
    D_.d2 += h * D_.d3;
    for (std::size_t i = last_.last; i < span.last; ++i) bend(i, 1.0);
    for (std::size_t i = last_.segment + 1; i <= span.segment; ++i) {
      D_.d1 -= path_.dd_[i];  // of the polyline
      bend(i, -2.0);
    }
    for (std::size_t i = last_.first; i < span.first; ++i) bend(i, 1.0);
    return span.to - anchor_ <= kMaxWindows * narrowest_;
  }
  void bend(std::size_t i, double times) {
    const double w = path_.w_[i];
    D_.d3 += path_.dd_[i] * (times / (w * w));
    narrowest_ = std::min(narrowest_, w);
  }

  const SmoothingWindows& path_;
  Deviation D_;
  Span last_;
  double anchor_ = 0.0, narrowest_ = 0.0;  // m
  int steps_ = kMaxSteps;
};

// Square of the deviation on a span of length h over its tolerance, from the control points of
// the cubic.
double SmoothingWindows::square_excess(const Deviation& D, double h, std::size_t segment) const {
  const Joints b1 = D.d0 + (h / 3.0) * D.d1;
  const Joints b2 = b1 + (h / 3.0) * (D.d1 + (0.5 * h) * D.d2);
  const Joints b3 = D.d0 + h * (D.d1 + (0.5 * h) * (D.d2 + (h / 3.0) * D.d3));
  const Polyline::Traits& to = v_.traits(segment + 1);
  const auto largest = [&](auto&& square) {
    return std::max({square(D.d0), square(b1), square(b2), square(b3)});
  };
  const double linear =
      largest([](const Joints& b) { return b.head<kLinearJoints>().squaredNorm(); });
  const double rotary =
      largest([](const Joints& b) { return b.tail<kJoints - kLinearJoints>().squaredNorm(); });
  return std::max(linear / (to.tolerance_linear * to.tolerance_linear),
                  rotary / (to.tolerance_rotary * to.tolerance_rotary));
}

// Narrows the windows until the deviation is within `share` of the tolerance everywhere. From the
// second pass on only what a changed window covers, or has covered, is looked at.
void SmoothingWindows::fit(double share) {
  const double most = share * (1.0 + kFits);
  std::vector<double> scale(n_ + 1), before;
  std::vector<std::pair<double, double>> parts = {{0.0, s_[n_]}};
  while (!parts.empty()) {
    throw_if_interrupted();
    std::fill(scale.begin(), scale.end(), 1.0);
    bool fits = true;
    RollingDeviation deviation(*this);
    for (const auto& [begin, end] : parts) {
      for_each_span(begin, end, [&](const Span& span) {
        const double square = square_excess(deviation.at(span), span.to - span.from, span.segment);
        if (square <= most * most) return;
        fits = false;
        const double factor = std::max(0.5, 0.99 * std::sqrt(share / std::sqrt(square)));
        for (std::size_t i = span.first; i < span.last; ++i) {
          scale[i] = std::min(scale[i], factor);
        }
      });
    }
    if (fits) return;
    before = w_;
    for (std::size_t i = 0; i <= n_; ++i) w_[i] *= scale[i];
    limit_slope();
    parts.clear();
    for (std::size_t i = 0; i < n_; ++i) {
      if (w_[i] == before[i]) continue;
      const double begin = s_[i] - before[i], end = s_[i] + before[i];
      if (parts.empty() || parts.back().second < begin)
        parts.emplace_back(begin, end);
      else
        parts.back().second = end;
    }
  }
}

// Moves the points of arcs so that the smoothed curve, not the polygon, passes the circle. Fades
// out towards neighbours that are not on the same arc.
void SmoothingWindows::pull_arcs_outward() {
  std::vector<Joints> moved(n_ + 1);
  for (std::size_t i = 0; i <= n_; ++i) {
    moved[i] = v_.u(i);
    if (v_.traits(i).arc < 0 || w_[i] <= 0.0) continue;
    std::size_t first = i, last = i + 1;
    while (first > 1 && s_[first - 1] + w_[first - 1] > s_[i]) --first;
    while (last < n_ && s_[last] - w_[last] < s_[i]) ++last;
    const Joints error = v_.u(i) + deviation(s_[i], s_[i], first, last).d0 - target_[i];
    moved[i] -= fade(i) * error;
  }
  for (std::size_t i = 0; i <= n_; ++i) v_.move_to(i, moved[i]);
  measure();
  for (std::size_t i = 1; i < n_; ++i) w_[i] = std::min({w_[i], s_[i], s_[n_] - s_[i]});
  limit_slope();
}

double SmoothingWindows::fade(std::size_t i) const {
  const double reach = 2.0 * w_[i];
  double distance = reach;
  const auto look = [&](auto step) {
    for (std::size_t k = i;; k = step(k)) {
      if (std::abs(s_[k] - s_[i]) >= reach) return;
      if (v_.traits(k).arc == v_.traits(i).arc) continue;
      if (k != 0 && k != n_) distance = std::min(distance, std::abs(s_[k] - s_[i]));
      return;  // another move, or the end of the path, where nothing has to be met
    }
  };
  look([](std::size_t k) { return k - 1; });
  look([](std::size_t k) { return k + 1; });
  const double x = distance / reach;
  return x * x * (3.0 - 2.0 * x);
}

}  // namespace servomill::controllers

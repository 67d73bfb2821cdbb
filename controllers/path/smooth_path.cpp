#include "controllers/path/smooth_path.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "controllers/path/fair_spline.h"
#include "plant/vocabulary/interrupt.h"

namespace servomill::controllers {
namespace {

constexpr std::size_t kMaxReach = 64;  // vertices on either side that a window may cover
constexpr double kLeastPiece = 1e-12;  // m, knots closer than this are one
constexpr double kArcMargin = 0.9;     // of the tolerance: room for moving arc points outward
constexpr double kFits = 1e-9;         // rounding of the deviation, of the tolerance
constexpr double kShrink = 0.85;       // step of the search for a window
constexpr double kDense = 1.5;         // chords in a window, above which a spline pays
constexpr std::size_t kLeastRun = 16;  // vertices that are worth a spline
constexpr std::size_t kBlock = 512;    // vertices of one spline
constexpr std::size_t kOverlap = 48;   // of them are done again with the next
constexpr int kArcPasses = 3;          // each leaves (w/R)^2 of the error before

struct Deviation {
  Joints d0 = Joints::Zero(), d1 = Joints::Zero(), d2 = Joints::Zero(), d3 = Joints::Zero();
};

double linear_norm(const Joints& u) { return u.head<kLinearJoints>().norm(); }
double rotary_norm(const Joints& u) { return u.tail<kJoints - kLinearJoints>().norm(); }

class Smoother {
 public:
  Smoother(Polyline vertices, const Joints& jerk)
      : v_(std::move(vertices)), n_(v_.size() - 1), jerk_(jerk.cwiseMax(1e-12)) {
    for (std::size_t i = 0; v_.has_arcs() && i < v_.size(); ++i) target_.push_back(v_.u(i));
    measure();
  }

  SmoothPath run() {
    const bool arcs = v_.has_arcs();
    const double share = arcs ? kArcMargin : 1.0;
    choose_windows(share);
    fit_windows(share);
    if (arcs) {
      for (int pass = 0; pass < kArcPasses; ++pass) pull_arcs_outward();
      fit_windows(1.0);
    }
    return build();
  }

 private:
  void measure() {
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

  // Direction of a chord.
  Joints direction(std::size_t k) const {
    const Joints chord = v_.u(k + 1) - v_.u(k);
    const double length = chord.norm();
    return chord / length;
  }

  // Deviation at vertex i if it and its neighbours all had the window w.
  Joints deviation_with(std::size_t i, double w) const {
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
  void choose_windows(double share) {
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

  void limit_slope() {
    for (std::size_t i = 1; i <= n_; ++i) w_[i] = std::min(w_[i], w_[i - 1] + (s_[i] - s_[i - 1]));
    for (std::size_t i = n_; i-- > 0;) w_[i] = std::min(w_[i], w_[i + 1] + (s_[i + 1] - s_[i]));
    w_[n_] = 0.0;
  }

  // A part of the path between two knots; windows first..last-1 are active on it.
  struct Span {
    double from = 0.0, to = 0.0;  // m
    std::size_t segment = 0;      // chord
    std::size_t first = 0, last = 0;
    double middle() const { return 0.5 * (from + to); }
  };

  // Calls f for every span from `begin` to `end`. Begins and ends of windows rise with their index.
  template <class F>
  void for_each_span(double begin, double end, F&& f) const {
    const auto first_behind = [&](auto&& knot) {
      std::size_t low = 1, high = n_;
      while (low < high) {
        const std::size_t i = (low + high) / 2;
        if (knot(i) <= begin)
          low = i + 1;
        else
          high = i;
      }
      return low;
    };
    const auto rise = [&](std::size_t i) { return i < n_ ? s_[i] - w_[i] : end; };
    const auto peak = [&](std::size_t i) { return i < n_ ? s_[i] : end; };
    const auto fall = [&](std::size_t i) { return i < n_ ? s_[i] + w_[i] : end; };
    // next knot of each kind
    std::size_t i_rise = first_behind(rise), i_peak = first_behind(peak);
    std::size_t i_fall = first_behind(fall);
    Span span{begin, begin, i_peak - 1, i_fall, i_rise};
    while (end - span.from > kLeastPiece) {
      const double next = std::min({rise(i_rise), peak(i_peak), fall(i_fall), end});
      span.to = std::max(next, span.from);
      while (i_rise < n_ && rise(i_rise) <= next) ++i_rise;
      while (i_peak < n_ && peak(i_peak) <= next) ++i_peak;
      while (i_fall < n_ && fall(i_fall) <= next) ++i_fall;
      if (end - span.to <= kLeastPiece) span.to = end;
      if (span.to - span.from <= kLeastPiece) continue;
      const double middle = span.middle();
      while (span.segment + 1 < n_ && s_[span.segment + 1] <= middle) ++span.segment;
      while (span.first < n_ && fall(span.first) <= middle) ++span.first;
      while (span.last < n_ && rise(span.last) < middle) ++span.last;
      span.last = std::max(span.first, span.last);
      f(span);
      span.from = span.to;
    }
  }

  // Deviation (2) and its derivatives at `x`, from the windows first..last-1.
  Deviation deviation(double x, double middle, std::size_t first, std::size_t last) const {
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
  class RollingDeviation {
   public:
    explicit RollingDeviation(const Smoother& path) : path_(path) {}

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
    static constexpr int kMostSteps = 32;
    static constexpr double kMostWindows = 16.0;

    bool roll(const Span& span) {
      if (++steps_ > kMostSteps || span.from != last_.to) return false;
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
      return span.to - anchor_ <= kMostWindows * narrowest_;
    }
    void bend(std::size_t i, double times) {
      const double w = path_.w_[i];
      D_.d3 += path_.dd_[i] * (times / (w * w));
      narrowest_ = std::min(narrowest_, w);
    }

    const Smoother& path_;
    Deviation D_;
    Span last_;
    double anchor_ = 0.0, narrowest_ = 0.0;  // m
    int steps_ = kMostSteps;
  };

  // Square of the deviation on a span of length h over its tolerance, from the control points of
  // the cubic.
  double square_excess(const Deviation& D, double h, std::size_t segment) const {
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
  void fit_windows(double share) {
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
          const double square =
              square_excess(deviation.at(span), span.to - span.from, span.segment);
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
  void pull_arcs_outward() {
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

  double fade(std::size_t i) const {
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

  // Place, direction and curvature of the smoothed polyline at s, on chord k.
  FairSpline::State state_at(double s, std::size_t k) const {
    std::size_t first = k + 1, last = k + 1;
    while (first > 1 && s_[first - 1] + w_[first - 1] > s) --first;
    while (last < n_ && s_[last] - w_[last] < s) ++last;
    const Deviation D = deviation(s, s, first, last);
    const Joints d = direction(k);
    return {s, v_.u(k) + d * (s - s_[k]) + D.d0, d + D.d1, D.d2, k};
  }

  // Is the window at vertex i wide enough to cover its neighbours?
  bool is_dense(std::size_t i) const {
    if (v_.traits(i).arc >= 0 || v_.traits(i + 1).arc >= 0) return false;
    return w_[i] > kDense * std::min(s_[i] - s_[i - 1], s_[i + 1] - s_[i]);
  }

  // Splines through runs of short chords.
  struct Faired {
    double from = 0.0, to = 0.0;      // m
    std::size_t first = 0, last = 0;  // pieces
  };

  void fair() {
    for (std::size_t i = 1; i < n_;) {
      throw_if_interrupted();
      if (!is_dense(i)) {
        ++i;
        continue;
      }
      std::size_t j = i;
      while (j + 1 < n_ && is_dense(j + 1)) ++j;
      if (j - i >= kLeastRun) fair_run(i, j);
      i = j + 1;
    }
  }

  // Progress of fairing a run of vertices: splines of overlapping blocks.
  struct Run {
    std::size_t next = 0, last = 0;  // vertices not yet done
    std::size_t length = kBlock;
    FairSpline::State begin, end;
    std::vector<CubicPiece> tail;  // of the last spline, beyond where the next begins
    double tail_end = 0.0;
  };

  // Windows outside the run that reach into it are left alone.
  void fair_run(std::size_t i, std::size_t j) {
    const double a = std::clamp(s_[i - 1] + w_[i - 1], std::max(s_[i] - w_[i], s_[i - 1]), s_[i]);
    const double b = std::clamp(s_[j + 1] - w_[j + 1], s_[j], std::min(s_[j] + w_[j], s_[j + 1]));
    Run run;
    run.next = i, run.last = j;
    run.begin = state_at(a, i - 1), run.end = state_at(b, j);
    while (run.next <= run.last) {
      throw_if_interrupted();
      const std::size_t to = std::min(run.next + run.length, run.last);
      if (to - run.next < kLeastRun) break;
      const FairSpline::State stop = to == j ? run.end : state_at(s_[to], to);
      if (spline_.fit(v_, s_, w_, jerk_, run.begin, stop)) {
        accept(run, to, stop);
      } else if (!run.tail.empty()) {
        finish_tail(run);
      } else {
        try_less(run, to);
      }
    }
    finish_tail(run);
  }

  // Keeps the spline up to some vertices before its end; there the next one begins.
  void accept(Run& run, std::size_t to, const FairSpline::State& stop) {
    const std::vector<CubicPiece>& pieces = spline_.pieces();
    std::size_t cut = pieces.size();
    const bool ends = to == run.last;
    if (!ends) {
      while (pieces[cut - 1].s > s_[to - std::min(kOverlap, (to - run.next) / 2)]) --cut;
      --cut;
    }
    const auto middle = pieces.begin() + static_cast<std::ptrdiff_t>(cut);
    open(run.begin.s);
    fair_.insert(fair_.end(), pieces.begin(), middle);
    run.tail.assign(middle, pieces.end());
    run.tail_end = stop.s;
    run.begin = ends ? stop : spline_.state_at(cut);
    close(run.begin.s);
    run.next = ends ? to + 1 : run.begin.chord + 1;
    run.length = kBlock;
  }

  // No spline joins the last one: that one stays to its end.
  void finish_tail(Run& run) {
    if (run.tail.empty()) return;
    fair_.insert(fair_.end(), run.tail.begin(), run.tail.end());
    close(run.tail_end);
    run.tail.clear();
    while (run.next <= run.last && s_[run.next] <= run.tail_end) ++run.next;
    run.begin = state_at(run.tail_end, run.next - 1);
  }

  // Fewer vertices; if they are few, what is between windows stays as it is.
  void try_less(Run& run, std::size_t to) const {
    if (to - run.next > 2 * kLeastRun) {
      run.length = (to - run.next) / 2;
      return;
    }
    run.next = to + 1;
    run.begin = state_at(s_[to], to);
    run.length = kBlock;
  }

  void open(double s) {
    if (faired_.empty() || faired_.back().to != s) {
      faired_.push_back({s, s, fair_.size(), fair_.size()});
    }
  }
  void close(double s) {
    faired_.back().to = s;
    faired_.back().last = fair_.size();
  }

  SmoothPath build() {
    fair();
    SmoothPath path;
    path.s = s_;
    path.pieces.reserve(fair_.size());
    std::size_t next = 0;
    const auto add = [&](double from, double middle, std::size_t k, std::size_t first,
                         std::size_t last) {
      const Deviation D = deviation(from, middle, first, last);
      const Joints d = direction(k);
      path.pieces.push_back({from, v_.u(k) + d * (from - s_[k]) + D.d0, d + D.d1, D.d2, D.d3, k});
    };
    for_each_span(0.0, s_[n_], [&](const Span& span) {
      const auto [from, to, k, first, last] = span;
      const double middle = span.middle();
      while (next < faired_.size() && faired_[next].to <= from + kLeastPiece) ++next;
      double at = from;
      for (; next < faired_.size() && faired_[next].from < to; ++next) {
        const Faired& run = faired_[next];
        if (run.from > at + kLeastPiece) add(at, middle, k, first, last);
        if (run.from >= from) {
          path.pieces.insert(path.pieces.end(),
                             fair_.begin() + static_cast<std::ptrdiff_t>(run.first),
                             fair_.begin() + static_cast<std::ptrdiff_t>(run.last));
        }
        at = run.to;
        if (run.to > to - kLeastPiece) break;
      }
      if (at < to - kLeastPiece) add(at, middle, k, first, last);
    });
    return path;
  }

  Polyline v_;
  std::size_t n_;  // chords
  Joints jerk_;
  std::vector<Joints> target_;  // of arcs alone
  std::vector<double> s_, w_;
  std::vector<Joints> dd_;
  FairSpline spline_;
  std::vector<CubicPiece> fair_;
  std::vector<Faired> faired_;
};

}  // namespace

SmoothPath smooth(Polyline vertices, const Joints& jerk) {
  assert(vertices.size() >= 2);
  return Smoother(std::move(vertices), jerk).run();
}

}  // namespace servomill::controllers

/// Windows at the vertices of a polyline, which smooth it within its tolerances (smooth_path.h).
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "controllers/path/polyline.h"
#include "controllers/path/smooth_path.h"
#include "plant/vocabulary/axes.h"

namespace servomill::controllers {

/// A polyline with the half-width w of the window at each vertex. Knots of the smoothed path are
/// the vertices and both ends of their windows.
class SmoothingWindows {
 public:
  static constexpr double kMinPiece = 1e-12;  // m, knots closer than this are one

  /// Deviation from the polyline, equation (2) of smooth_path.h, and its derivatives by s.
  struct Deviation {
    Joints d0 = Joints::Zero(), d1 = Joints::Zero(), d2 = Joints::Zero(), d3 = Joints::Zero();
  };

  /// A part of the path between two knots; windows first..last-1 are active on it.
  struct Span {
    double from = 0.0, to = 0.0;  // m
    std::size_t segment = 0;      // chord
    std::size_t first = 0, last = 0;
    double middle() const { return 0.5 * (from + to); }
  };

  /// @pre no chord has length 0
  explicit SmoothingWindows(Polyline vertices);

  /// Chooses the widest windows that keep the tolerances; points of arcs are moved so that the
  /// smoothed path passes through their circle.
  void choose();

  const Polyline& vertices() const { return v_; }
  std::size_t chords() const { return n_; }
  const std::vector<double>& s() const { return s_; }      // m, of the vertices
  const std::vector<double>& width() const { return w_; }  // m, half of each window

  /// A vertex before points of arcs and splines were moved.
  const Joints& programmed(std::size_t i) const { return target_.empty() ? v_.u(i) : target_[i]; }

  /// State of the smoothed polyline at s, on that chord.
  PathState state_at(double s, std::size_t chord) const;
  /// Its piece on a span from there on.
  CubicPiece piece(const Span& span, double from) const;

  /// Direction of a chord.
  Joints direction(std::size_t chord) const;

  /// The deviation at `x` from the windows first..last-1.
  /// @param middle  of the span on which x is
  Deviation deviation(double x, double middle, std::size_t first, std::size_t last) const;

  /// Calls f for every span from `begin` to `end`. Begins and ends of windows rise with their
  /// index.
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
    while (end - span.from > kMinPiece) {
      const double next = std::min({rise(i_rise), peak(i_peak), fall(i_fall), end});
      span.to = std::max(next, span.from);
      while (i_rise < n_ && rise(i_rise) <= next) ++i_rise;
      while (i_peak < n_ && peak(i_peak) <= next) ++i_peak;
      while (i_fall < n_ && fall(i_fall) <= next) ++i_fall;
      if (end - span.to <= kMinPiece) span.to = end;
      if (span.to - span.from <= kMinPiece) continue;
      const double middle = span.middle();
      while (span.segment + 1 < n_ && s_[span.segment + 1] <= middle) ++span.segment;
      while (span.first < n_ && fall(span.first) <= middle) ++span.first;
      while (span.last < n_ && rise(span.last) < middle) ++span.last;
      span.last = std::max(span.first, span.last);
      f(span);
      span.from = span.to;
    }
  }

 private:
  class RollingDeviation;

  void measure();
  Joints deviation_with(std::size_t i, double w) const;
  void choose_each(double share);
  void limit_slope();
  double square_excess(const Deviation& D, double h, std::size_t segment) const;
  void fit(double share);
  void pull_arcs_outward();
  double fade(std::size_t i) const;

  Polyline v_;
  std::size_t n_;               // chords
  std::vector<Joints> target_;  // vertices as programmed; of arcs alone
  std::vector<double> s_, w_;   // m
  std::vector<Joints> dd_;      // change of direction at each vertex
};

}  // namespace servomill::controllers

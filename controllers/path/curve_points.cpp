#include "controllers/path/curve_points.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace servomill::controllers {
namespace {

constexpr double kChordAngle = 0.1;     // rad, longest chord of an arc
constexpr double kChordsPerWindow = 4;  // chords of an arc in the half-width of its window
constexpr double kSameCircle = 1e-9;    // m, by which circles that are meant to be one may differ
constexpr double kGrowth = 0.25;        // of the way, by which chords may grow along it
constexpr double kMinChord = 0.1;       // of the tolerance, the shortest chord: at cusps
constexpr double kEven = 1e-9;          // relative, chords that are alike
constexpr double kRounding = 1e-9;      // of a chord
constexpr double kSameTurn = 1e-3;      // rad, between curves that go on in each other
constexpr double kSameBend = 0.05;      // of the curvature, the same
constexpr double kFlat = 1e-3;          // 1/m, a curvature that counts as none

// Longest chords along a part of a curve without a break: linear between samples, so that the
// number of chords goes like a logarithm.
class ChordLengths {
 public:
  ChordLengths(const SplineCurve& curve, double from, double to, double tolerance) {
    add(curve, from, tolerance);
    for (const double s : curve.samples()) {
      if (s > from && s < to) add(curve, s, tolerance);
    }
    add(curve, to, tolerance);
    for (std::size_t i = 1; i < s_.size(); ++i) limit(i, i - 1);
    for (std::size_t i = s_.size() - 1; i-- > 0;) limit(i, i + 1);
    counts_.push_back(0.0);
    for (std::size_t i = 1; i < s_.size(); ++i) {
      const double way = s_[i] - s_[i - 1], ratio = h_[i] / h_[i - 1] - 1.0;
      const double count =
          std::isinf(h_[i])
              ? 0.0
              : way / h_[i - 1] * (std::abs(ratio) > kEven ? std::log1p(ratio) / ratio : 1.0);
      counts_.push_back(counts_.back() + count);
    }
  }

  /// Chords from the beginning to the end.
  double count() const { return counts_.back(); }

  /// Arc length behind so many chords.
  double s_behind(double count) const {
    const auto above = std::upper_bound(counts_.begin(), counts_.end() - 1, count);
    const auto i = static_cast<std::size_t>(above - counts_.begin());
    const double share = (count - counts_[i - 1]) / (counts_[i] - counts_[i - 1]);
    const double ratio = h_[i] / h_[i - 1] - 1.0;
    const double way =
        std::abs(ratio) > kEven ? std::expm1(share * std::log1p(ratio)) / ratio : share;
    return s_[i - 1] + way * (s_[i] - s_[i - 1]);
  }

 private:
  void add(const SplineCurve& curve, double s, double tolerance) {
    const double bend = curve.state(s).curvature.norm();
    const double radius = 1.0 / bend;
    const double h = bend > 0.0 ? radius * chord_angle(radius, tolerance)
                                : std::numeric_limits<double>::infinity();
    s_.push_back(s);
    h_.push_back(std::max(h, kMinChord * tolerance));
  }
  void limit(std::size_t i, std::size_t neighbour) {
    h_[i] = std::min(h_[i], h_[neighbour] + kGrowth * std::abs(s_[i] - s_[neighbour]));
  }

  std::vector<double> s_, h_, counts_;
};

}  // namespace

double chord_angle(double radius, double tolerance) {
  const double window = std::sqrt(12.0 * tolerance * radius);
  return std::min(kChordAngle, window / kChordsPerWindow / radius);
}

std::vector<CurvePoint> points_of(const SplineCurve& curve, double tolerance) {
  std::vector<CurvePoint> out;
  if (curve.length() == 0.0) return out;
  std::vector<double> ends = curve.breaks();
  ends.push_back(curve.length());
  double from = 0.0;
  for (const double to : ends) {
    if (!(to > from)) continue;
    const ChordLengths chords(curve, from, to, tolerance);
    const double n = std::max(1.0, std::ceil(chords.count() - kRounding));
    for (double i = 1.0; i < n; ++i) {
      const double s = chords.s_behind(chords.count() * i / n);
      out.push_back({curve.point(s), s / curve.length(), true});
    }
    out.push_back({curve.point(to), to / curve.length(), false});
    from = to;
  }
  return out;
}

std::optional<CurveEnd> end_of_circle(const ArcSweep& arc, const Joints& step, double fraction) {
  const bool is_flat = std::abs(arc.along_end - arc.along_begin) < kSameCircle &&
                       std::abs(arc.r_end - arc.r_begin) < kSameCircle &&
                       step.tail<kJoints - kLinearJoints>().isZero(0.0);
  if (!is_flat) return std::nullopt;
  Eigen::Vector3d to_centre = -arc.point(fraction);
  to_centre[arc.a] += arc.centre_a;
  to_centre[arc.b] += arc.centre_b;
  to_centre[arc.c] = 0.0;
  return CurveEnd{arc.derivative(fraction).normalized(), to_centre / to_centre.squaredNorm()};
}

bool goes_on(const CurveEnd& end, const CurveEnd& begin) {
  const double bend = std::max(end.curvature.norm(), begin.curvature.norm());
  return (begin.tangent - end.tangent).norm() <= kSameTurn &&
         (begin.curvature - end.curvature).norm() <= kSameBend * bend + kFlat;
}

bool is_same_circle(const ArcSweep& one, const ArcSweep& next, const Joints& step) {
  const auto near = [](double a, double b) { return std::abs(a - b) < kSameCircle; };
  const bool is_flat = near(one.along_begin, one.along_end) &&
                       near(next.along_begin, next.along_end) &&
                       step.tail<kJoints - kLinearJoints>().isZero(0.0);
  return is_flat && one.c == next.c && (one.sweep > 0.0) == (next.sweep > 0.0) &&
         near(one.centre_a, next.centre_a) && near(one.centre_b, next.centre_b) &&
         near(one.r_begin, next.r_begin) && near(one.r_end, next.r_end) &&
         near(one.r_begin, one.r_end);
}

}  // namespace servomill::controllers

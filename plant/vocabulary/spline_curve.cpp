#include "plant/vocabulary/spline_curve.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace servomill {
namespace {

constexpr double kLengthTol = 1e-13;  // m, of the length of a cell
constexpr int kMaxHalvings = 40;      // of a Bezier curve, at cusps
// Far more than any path has: coordinates of 1e20 m leave more rounding than kLengthTol everywhere.
constexpr std::size_t kMaxCells = 20000;
constexpr double kStill = 1e-9;        // of the length: derivative by t below which it stands
constexpr double kBeside = 1e-5;       // t, how far beside a standstill its direction is taken
constexpr double kCornerAngle = 1e-4;  // rad, sharper ones are corners
constexpr double kBendJump = 0.05;     // of the curvature
constexpr double kFlat = 1e-3;         // 1/m, a curvature that counts as none
constexpr double kCuspAngle = 1.0;     // rad, within a cell
constexpr double kTiny = 1e-4;         // t, cells that only cusps are cut into
constexpr std::size_t kSamples = 8;    // of a cell, in which a closest point is looked for
constexpr int kSolverSteps = 60;

// Gauss' rule of eight points on [-1, 1]: half of the symmetric nodes and their weights.
constexpr std::array<double, 4> kNodes = {0.1834346424956498, 0.5255324099163290,
                                          0.7966664774136267, 0.9602898564975363};
constexpr std::array<double, 4> kWeights = {0.3626837833783620, 0.3137066458778873,
                                            0.2223810344533745, 0.1012285362903763};

// Root of a function that changes its sign in [a, b]; Newton's step where it stays inside.
// @param f  value and derivative
template <class Function>
double root_in(double a, double b, double start, Function f) {
  double t = start;
  for (int n = 0; n < kSolverSteps && b - a > 0.0; ++n) {
    const auto [value, slope] = f(t);
    if (value == 0.0) return t;
    (value > 0.0 ? b : a) = t;
    const double newton = t - value / slope;
    const double next = newton > a && newton < b ? newton : 0.5 * (a + b);
    if (next == t || next <= a || next >= b) return t;
    t = next;
  }
  return t;
}

}  // namespace

SplineCurve::SplineCurve(int order, std::vector<Eigen::Vector3d> points,
                         std::vector<double> weights)
    : order_(order), points_(std::move(points)), weights_(std::move(weights)) {
  assert(order_ >= 3 && points_.size() >= static_cast<std::size_t>(order_));
  assert(weights_.size() == points_.size());
  take_beziers();
  measure();
}

// Knot i of 0, 0, ..., 0, 1, 2, ..., n, n, ..., n.
double SplineCurve::knot(std::size_t i) const {
  const auto k = static_cast<std::size_t>(order_);
  const std::size_t last = points_.size() - k + 1;
  return i < k ? 0.0 : static_cast<double>(std::min(i - k + 1, last));
}

// Polar form of the homogeneous curve on [knot(span), knot(span + 1)]: de Boor's algorithm with
// another argument at each level.
Eigen::Vector4d SplineCurve::blossom(std::size_t span, const std::vector<double>& u) const {
  const auto degree = static_cast<std::size_t>(order_ - 1);
  std::vector<Eigen::Vector4d> d(degree + 1);
  for (std::size_t j = 0; j <= degree; ++j) {
    const std::size_t i = span - degree + j;
    d[j] << points_[i] * weights_[i], weights_[i];
  }
  for (std::size_t level = 1; level <= degree; ++level) {
    for (std::size_t j = degree; j >= level; --j) {
      const std::size_t i = span - degree + j;
      const double low = knot(i), high = knot(i + degree - level + 1);
      const double share = (u[level - 1] - low) / (high - low);
      d[j] = (1.0 - share) * d[j - 1] + share * d[j];
    }
  }
  return d[degree];
}

void SplineCurve::take_beziers() {
  const auto degree = static_cast<std::size_t>(order_ - 1);
  for (std::size_t span = degree; span < points_.size(); ++span) {
    Bezier bezier;
    for (std::size_t i = 0; i <= degree; ++i) {
      std::vector<double> u(degree, knot(span));
      std::fill_n(u.begin(), i, knot(span + 1));
      bezier.push_back(blossom(span, u));
    }
    beziers_.push_back(std::move(bezier));
  }
}

// De Casteljau's algorithm, and the rule for quotients.
SplineCurve::Derivatives SplineCurve::derivatives(const Place& at) const {
  Bezier c = beziers_[at.bezier];
  const std::size_t degree = c.size() - 1;
  const auto d = static_cast<double>(degree);
  const auto step = [&](std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) c[i] = (1.0 - at.t) * c[i] + at.t * c[i + 1];
  };
  for (std::size_t left = degree; left > 2; --left) step(left);
  const Eigen::Vector4d h2 = d * (d - 1.0) * (c[2] - 2.0 * c[1] + c[0]);
  step(2);
  const Eigen::Vector4d h1 = d * (c[1] - c[0]);
  step(1);
  const double w = c[0][3];
  Derivatives out;
  out.p = c[0].head<3>() / w;
  out.d1 = (h1.head<3>() - h1[3] * out.p) / w;
  out.d2 = (h2.head<3>() - 2.0 * h1[3] * out.d1 - h2[3] * out.p) / w;
  return out;
}

double SplineCurve::part_length(std::size_t bezier, double from, double to) const {
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
  double sum = 0.0;
  for (std::size_t i = 0; i < kNodes.size(); ++i) {
    for (const double side : {-1.0, 1.0}) {
      sum += kWeights[i] * derivatives({bezier, middle + side * half * kNodes[i]}).d1.norm();
    }
  }
  return half * sum;
}

void SplineCurve::measure_part(std::size_t bezier, double from, double to, double whole,
                               int depth) {
  const double middle = 0.5 * (from + to);
  const double first = part_length(bezier, from, middle);
  const double second = part_length(bezier, middle, to);
  const bool is_exact = std::abs(first + second - whole) <= kLengthTol;
  if (!is_exact && depth < kMaxHalvings && cells_.size() < kMaxCells) {
    measure_part(bezier, from, middle, first, depth + 1);
    measure_part(bezier, middle, to, second, depth + 1);
    return;
  }
  cells_.push_back({bezier, from, middle, length_});
  cells_.push_back({bezier, middle, to, length_ + first});
  length_ += first + second;
}

void SplineCurve::measure() {
  for (std::size_t i = 0; i < beziers_.size(); ++i) {
    measure_part(i, 0.0, 1.0, part_length(i, 0.0, 1.0), 0);
  }
}

std::size_t SplineCurve::cell_of(double s) const {
  const auto behind = std::upper_bound(cells_.begin(), cells_.end(), s,
                                       [](double x, const Cell& cell) { return x < cell.s; });
  return behind == cells_.begin() ? 0 : static_cast<std::size_t>(behind - cells_.begin()) - 1;
}

SplineCurve::Place SplineCurve::place(double s) const {
  const std::size_t index = cell_of(s);
  const Cell& cell = cells_[index];
  const double end = index + 1 < cells_.size() ? cells_[index + 1].s : length_;
  const double wanted = s - cell.s;
  if (wanted <= 0.0) return {cell.bezier, cell.from};
  if (s >= end) return {cell.bezier, cell.to};
  const double start = cell.from + (cell.to - cell.from) * wanted / (end - cell.s);
  const double t = root_in(cell.from, cell.to, start, [&](double at) {
    return std::pair(part_length(cell.bezier, cell.from, at) - wanted,
                     derivatives({cell.bezier, at}).d1.norm());
  });
  return {cell.bezier, t};
}

Eigen::Vector3d SplineCurve::point(double s) const {
  if (s <= 0.0) return points_.front();
  if (s >= length_) return points_.back();
  return derivatives(place(s)).p;
}

// @param side  1 or -1: on which side of a standstill
SplineCurve::State SplineCurve::state_at(const Place& at, double side) const {
  Derivatives d = derivatives(at);
  State out;
  out.p = d.p;
  if (d.d1.norm() <= kStill * length_) d = derivatives({at.bezier, at.t + side * kBeside});
  const double speed = d.d1.norm();
  if (speed == 0.0) return out;
  out.tangent = d.d1 / speed;
  out.curvature = (d.d2 - out.tangent * out.tangent.dot(d.d2)) / (speed * speed);
  return out;
}

SplineCurve::State SplineCurve::state(double s) const {
  const Place at = place(std::clamp(s, 0.0, length_));
  return state_at(at, at.t < 0.5 ? 1.0 : -1.0);
}

std::vector<double> SplineCurve::samples() const {
  std::vector<double> out;
  for (const Cell& cell : cells_) {
    const double step = (cell.to - cell.from) / kSamples;
    double s = cell.s, t = cell.from;
    for (std::size_t n = 0; n < kSamples; ++n, t += step) {
      out.push_back(s);
      s += part_length(cell.bezier, t, t + step);
    }
  }
  out.push_back(length_);
  return out;
}

// A break lies where two cells meet, or in a cell that was halved as often as is needed.
std::vector<double> SplineCurve::breaks() const {
  std::vector<double> out;
  const auto is_break = [&](const Place& a, const Place& b, double angle) {
    const State before = state_at(a, -1.0), behind = state_at(b, 1.0);
    const double bend = std::max(before.curvature.norm(), behind.curvature.norm());
    return (behind.tangent - before.tangent).norm() > angle ||
           (angle < kCuspAngle &&
            (behind.curvature - before.curvature).norm() > kBendJump * bend + kFlat);
  };
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const Cell& cell = cells_[i];
    const Place begin{cell.bezier, cell.from}, end{cell.bezier, cell.to};
    const Place before = i > 0 ? Place{cells_[i - 1].bezier, cells_[i - 1].to} : begin;
    const bool meets = i > 0 && is_break(before, begin, kCornerAngle);
    const bool holds = cell.to - cell.from < kTiny && is_break(begin, end, kCuspAngle);
    const bool is_known = !out.empty() && cell.s - out.back() < kBeside * length_;
    if ((meets || holds) && !is_known) out.push_back(cell.s);
  }
  return out;
}

// Best of the samples that are closer than their neighbours and of the places on both sides of
// them.
double SplineCurve::closest(const Eigen::Vector3d& p) const {
  const auto square = [&](const Place& at) { return (derivatives(at).p - p).squaredNorm(); };
  const std::size_t count = cells_.size() * kSamples;
  const auto sample = [&](std::size_t n) {
    const Cell& cell = cells_[std::min(n, count - 1) / kSamples];
    const double step = (cell.to - cell.from) / kSamples;
    return Place{cell.bezier,
                 n == count ? cell.to : cell.from + step * static_cast<double>(n % kSamples)};
  };
  std::vector<double> squares(count + 1);
  for (std::size_t n = 0; n <= count; ++n) squares[n] = square(sample(n));
  double least = std::numeric_limits<double>::infinity();
  Place best;
  std::size_t in = 0;  // cell of the best place
  const auto take = [&](const Place& at, std::size_t n) {
    const double here = square(at);
    if (here < least) least = here, best = at, in = n / kSamples;
  };
  for (std::size_t n = 0; n <= count; ++n) {
    const bool is_low =
        (n == 0 || squares[n] <= squares[n - 1]) && (n == count || squares[n] <= squares[n + 1]);
    const bool may_be_corner = n % kSamples == 0;
    if (!is_low && !may_be_corner) continue;
    take(sample(n), std::min(n, count - 1));
    if (n > 0) take(closest_in(n - 1, p), n - 1);
    if (n < count) take(closest_in(n, p), n);
  }
  const Cell& cell = cells_[in];
  return std::min(cell.s + part_length(cell.bezier, cell.from, best.t), length_);
}

// Place between two samples at which the distance from p is stationary, or the first of them.
SplineCurve::Place SplineCurve::closest_in(std::size_t interval, const Eigen::Vector3d& p) const {
  const Cell& cell = cells_[interval / kSamples];
  const double step = (cell.to - cell.from) / kSamples;
  const double low = cell.from + step * static_cast<double>(interval % kSamples);
  const auto slope = [&](double t) {  // of half the square of the distance
    const Derivatives d = derivatives({cell.bezier, t});
    return std::pair((d.p - p).dot(d.d1), d.d1.squaredNorm() + (d.p - p).dot(d.d2));
  };
  const auto halts = [&](double t) {
    return derivatives({cell.bezier, t}).d1.norm() <= kStill * length_;
  };
  const bool has_root = (halts(low) || slope(low).first < 0.0) &&
                        (halts(low + step) || slope(low + step).first > 0.0);
  return {cell.bezier, has_root ? root_in(low, low + step, low + 0.5 * step, slope) : low};
}

std::pair<Eigen::Vector3d, Eigen::Vector3d> SplineCurve::extent() const {
  Eigen::Vector3d low = points_.front(), high = points_.front();
  const auto include = [&](const Eigen::Vector3d& p) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  };
  include(points_.back());
  for (const Cell& cell : cells_) {
    const double step = (cell.to - cell.from) / kSamples;
    for (std::size_t n = 0; n < kSamples; ++n) {
      const double a = cell.from + step * static_cast<double>(n), b = a + step;
      const Eigen::Vector3d at_a = derivatives({cell.bezier, a}).d1;
      const Eigen::Vector3d at_b = derivatives({cell.bezier, b}).d1;
      include(derivatives({cell.bezier, a}).p);
      for (int i = 0; i < 3; ++i) {
        if (!(at_a[i] * at_b[i] < 0.0)) continue;
        const double side = at_a[i] < 0.0 ? 1.0 : -1.0;  // root_in wants it to rise
        const double t = root_in(a, b, 0.5 * (a + b), [&](double at) {
          const Derivatives d = derivatives({cell.bezier, at});
          return std::pair(side * d.d1[i], side * d.d2[i]);
        });
        include(derivatives({cell.bezier, t}).p);
      }
    }
  }
  return {low, high};
}

}  // namespace servomill

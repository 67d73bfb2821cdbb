#include "controllers/path/quicken.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace servomill::controllers {
namespace {

constexpr double kMargin = 0.99;   // of jerk and acceleration, for what lies between points
constexpr double kFirstMu = 5e-3;  // of the time that a point stands for
constexpr double kLastMu = 1e-4;
constexpr double kFall = 0.5;         // of mu, after a pass whose steps were not too short:
constexpr double kShortStep = 0.2;    // of the Newton step, mean of a pass
constexpr std::size_t kPasses = 12;   // four more gain 0.3 %
constexpr std::size_t kBlock = 64;    // coefficients that move together
constexpr double kFraction = 0.9;     // of a slack that one step may use
constexpr double kIdle = 0.1;         // of a limit, below which it does not bend the search
constexpr double kFirstScale = 0.81;  // of v^2, where the search begins
constexpr double kLeastScale = 0.01;  // below it there is nothing to gain
constexpr double kLongest = 8e-3;     // s, an interval
constexpr double kShortest = 3e-3;    // s, an interval
constexpr double kLeastSpeed = 1e-6;  // m/s
constexpr std::size_t kLeast = 4;     // intervals
constexpr int kHalvings = 3;          // of an interval, to bound the jerk between points

using Vector3 = Eigen::Vector3d;  // b, b', b''

class Quickener {
 public:
  Quickener(const TimeLaw& law, const SmoothPath& path, std::span<const double> v_top,
            const JointLimits& limits)
      : law_(law), path_(path), v_top_(v_top), limits_(limits) {}

  bool run(TimeLaw& out) {
    if (!find_region()) return false;
    lay_knots();
    if (N_ < kLeast) return false;
    form();
    place_points();
    start();
    if (!scale_into_limits()) return false;
    optimise();
    const double k = slow_down();
    return write(k, out);
  }

 private:
  struct Region {
    std::size_t first = 0, last = 0;  // phases of the law
    double s_begin = 0.0, s_end = 0.0, t_begin = 0.0, t_end = 0.0, v_begin = 0.0, v_end = 0.0;
  };
  struct Interval {
    Eigen::Matrix3d P;  // three coefficients -> b, b', b'' at its begin
  };
  struct Point {
    std::size_t interval = 0, piece = 0;
    double y = 0.0;       // m, from the begin of the interval
    double weight = 0.0;  // m, of the path
    double b_top = 0.0;
    Joints j0, j1, j2;  // (1), of the jerk, divided by J
    Joints a0, a1;      // of the acceleration, divided by A
  };

  // Between the first and the last instant at which the speed neither rises nor falls.
  bool find_region() {
    const auto& ph = law_.phases;
    const auto still = [&](std::size_t i) { return ph[i].a == 0.0 && ph[i].v > 0.0; };
    std::size_t first = 1;
    while (first < ph.size() && !still(first)) ++first;
    std::size_t last = ph.size();
    while (last > first && !(last - 1 > 0 && still(last - 1))) --last;
    if (last <= first) return false;
    --last;
    if (last <= first) return false;
    r_ = {first, last, ph[first].s, ph[last].s, ph[first].t, ph[last].t, ph[first].v, ph[last].v};
    return r_.s_end > r_.s_begin;
  }

  // Speed of the law at s; `phase` is where to look first.
  double speed_at(double s, std::size_t& phase) const {
    const auto& ph = law_.phases;
    while (phase + 1 < ph.size() && ph[phase + 1].s <= s) ++phase;
    const Phase& p = ph[phase];
    const double d = s - p.s;
    double t = p.v > 0.0 ? d / p.v : std::cbrt(6.0 * d / std::max(p.j, 1e-9));
    for (int i = 0; i < 6; ++i) {  // Newton; what is missed makes a start that is not quite the law
      const double v = p.v + t * (p.a + 0.5 * t * p.j);
      if (v <= 0.0) break;
      t -= (t * (p.v + t * (0.5 * p.a + t * p.j / 6.0)) - d) / v;
    }
    return std::max(p.v + t * (p.a + 0.5 * t * p.j), kLeastSpeed);
  }

  // Where pieces meet, unless they are short; long ones are divided.
  void lay_knots() {
    t_.assign(1, r_.s_begin);
    std::size_t phase = r_.first, i = 0;
    while (path_.end_of(i) <= r_.s_begin) ++i;
    first_piece_ = i;
    double v_from = r_.v_begin;
    for (; t_.back() < r_.s_end; ++i) {
      const double from = t_.back(), to = std::min(path_.end_of(i), r_.s_end);
      const double v_to = speed_at(to, phase);
      const double time = (to - from) / std::min(v_from, v_to);
      if (to < r_.s_end && time < kShortest) continue;
      const int n = std::max(1, static_cast<int>(std::ceil(time / kLongest)));
      for (int k = 1; k < n; ++k) t_.push_back(from + (to - from) * k / n);
      t_.push_back(to);
      v_from = v_to;
    }
    N_ = t_.size() - 1;
  }

  double knot(std::ptrdiff_t i) const {
    const auto n = static_cast<std::ptrdiff_t>(N_);
    if (i < 0) return 2.0 * t_[0] - t_[static_cast<std::size_t>(-i)];
    if (i > n) return 2.0 * t_[N_] - t_[static_cast<std::size_t>(2 * n - i)];
    return t_[static_cast<std::size_t>(i)];
  }

  void form() {
    intervals_.resize(N_);
    for (std::size_t k = 0; k < N_; ++k) {
      const auto n = static_cast<std::ptrdiff_t>(k);
      const double before = knot(n - 1), at = knot(n), next = knot(n + 1), after = knot(n + 2);
      const double D = next - before, E = after - at, h = next - at;
      Eigen::Matrix3d& P = intervals_[k].P;
      P.row(0) << h / D, (at - before) / D, 0.0;
      P.row(1) << -2.0 / D, 2.0 / D, 0.0;
      P.row(2) << 2.0 / (D * h), -2.0 / (D * h) - 2.0 / (E * h), 2.0 / (E * h);
    }
  }

  Vector3 state(std::size_t interval, const std::vector<double>& c) const {
    return intervals_[interval].P * Vector3(c[interval], c[interval + 1], c[interval + 2]);
  }
  static Vector3 shifted(const Vector3& x, double y) {
    return {x[0] + y * (x[1] + 0.5 * y * x[2]), x[1] + y * x[2], x[2]};
  }

  Point point(std::size_t interval, std::size_t piece, double s, double weight) const {
    Point p;
    p.interval = interval;
    p.piece = piece;
    p.y = s - t_[interval];
    p.weight = weight;
    p.b_top = v_top_[piece] * v_top_[piece];
    const CubicPiece& q = path_.pieces[piece];
    const double x = s - q.s;
    const Joints q1 = q.c1 + x * (q.c2 + 0.5 * x * q.c3), q2 = q.c2 + x * q.c3;
    const Joints J = limits_.j * kMargin, A = limits_.a * kMargin;
    p.j0 = q.c3.cwiseQuotient(J);
    p.j1 = 1.5 * q2.cwiseQuotient(J);
    p.j2 = 0.5 * q1.cwiseQuotient(J);
    p.a0 = q2.cwiseQuotient(A);
    p.a1 = 0.5 * q1.cwiseQuotient(A);
    return p;
  }

  // The control point of (1), a quadratic in s, between those at the ends.
  Point middle_point(std::size_t interval, std::size_t piece, double from, double to) const {
    Point p = point(interval, piece, 0.5 * (from + to), (to - from) * (2.0 / 3.0));
    const double square = (to - from) * (to - from) / 8.0;
    // L_m - h^2 L''/8 with L'' = 4.5 q''' b'';  M'' = 3 q''' b' /2 + 2 q'' b''
    p.j2 -= (4.5 * square) * p.j0;
    return p;
  }

  void place_points() {
    points_.clear();
    first_points_.clear();
    std::size_t piece = first_piece_;
    for (std::size_t k = 0; k < N_; ++k) {
      first_points_.push_back(points_.size());
      for (double at = t_[k]; at < t_[k + 1];) {
        while (piece + 1 < path_.pieces.size() && path_.end_of(piece) <= at) ++piece;
        const double to = std::min(path_.end_of(piece), t_[k + 1]);
        points_.push_back(point(k, piece, at, (to - at) / 6.0));
        points_.push_back(middle_point(k, piece, at, to));
        points_.push_back(point(k, piece, to, (to - at) / 6.0));
        at = to;
      }
    }
    first_points_.push_back(points_.size());
    band_.resize(N_ + 2);
  }

  void start() {
    c_.resize(N_ + 2);
    std::size_t phase = r_.first;
    for (std::size_t i = 1; i <= N_; ++i) {
      const double v = speed_at(0.5 * (t_[i - 1] + t_[i]), phase);
      c_[i] = v * v;
    }
    tie_ends();
  }
  void tie_ends() {
    c_[0] = c_[1];
    c_[N_ + 1] = c_[N_];
  }

  // Lowers b as a whole until all slacks are positive.
  bool scale_into_limits() {
    const double v_a = r_.v_begin, v_b = r_.v_end;
    double scale = kFirstScale;
    scale = std::min({scale, 0.98 * v_a * v_a / c_[1], 0.98 * v_b * v_b / c_[N_]});
    for (const Point& p : points_) {
      const Vector3 x = shifted(state(p.interval, c_), p.y);
      if (x[0] <= 0.0) return false;
      const Joints L = p.j0 * x[0] + p.j1 * x[1] + p.j2 * x[2];
      const Joints M = p.a0 * x[0] + p.a1 * x[1];
      const double jerk = L.cwiseAbs().maxCoeff() * std::sqrt(x[0]);
      scale = std::min(scale, 0.9 * std::pow(jerk, -2.0 / 3.0));
      scale = std::min(scale, 0.9 / std::max(M.cwiseAbs().maxCoeff(), 1e-12));
      scale = std::min(scale, 0.9 * p.b_top / x[0]);
    }
    for (double& c : c_) c *= scale;
    return scale > kLeastScale;
  }

  void optimise() {
    // the weight of a slack is the time of its part of the path
    for (Point& p : points_) {
      const double b = shifted(state(p.interval, c_), p.y)[0];
      p.weight = std::max(p.weight, 1e-12);
      slack_weight_.push_back(p.weight / std::sqrt(b));
    }
    step_.assign(N_ + 2, 0.0);
    double mu = kFirstMu;
    for (std::size_t pass = 0; pass < kPasses; ++pass) {
      // other blocks in every pass, so that none has a lasting border
      const std::size_t shift = kBlock / 4 * (pass % 4 + 1);
      double steps = 0.0, blocks = 0.0;
      for (std::size_t i = 1; i <= N_; blocks += 1.0) {
        std::size_t to = i == 1 ? i + shift : i + kBlock;
        if (to + kBlock / 4 > N_ + 1) to = N_ + 1;
        steps += step_block(i, to, mu);
        i = to;
      }
      if (steps > kShortStep * blocks) mu = std::max(mu * kFall, kLastMu);
    }
  }

  // One Newton step of the coefficients first..last-1, the others standing still; returns which
  // part of it was taken.
  double step_block(std::size_t first, std::size_t last, double mu) {
    const std::size_t from = first_points_[first < 3 ? 0 : first - 2];
    const std::size_t to = first_points_[std::min(last, N_)];
    assemble(mu, first, last, from, to);
    solve(first, last);
    if (first == 1) step_[0] = step_[1];
    if (last == N_ + 1) step_[N_ + 1] = step_[N_];
    const double alpha = std::min(1.0, kFraction / largest_loss(from, to));
    for (std::size_t i = first; i < last; ++i) {
      c_[i] += alpha * step_[i];
      step_[i] = 0.0;
    }
    tie_ends();
    step_[0] = step_[N_ + 1] = 0.0;
    return alpha;
  }

  void assemble(double mu, std::size_t first, std::size_t last, std::size_t from, std::size_t to) {
    for (std::size_t i = first; i < last; ++i) {
      band_[i] = {0.0, 0.0, 0.0};
      step_[i] = 0.0;
    }
    for (std::size_t n = from; n < to; ++n) {
      const Point& p = points_[n];
      const std::size_t k = p.interval;
      const Vector3 x = shifted(state(k, c_), p.y);
      const double w = mu * slack_weight_[n];
      const double b = x[0], r = 1.0 / std::sqrt(b), r_b = -0.5 * r / b;
      // time
      double g0 = p.weight * r_b, g1 = 0.0, g2 = 0.0;
      double h00 = -1.5 * p.weight * r_b / b, h01 = 0.0, h02 = 0.0, h11 = 0.0, h12 = 0.0, h22 = 0.0;
      // speed
      const double top = 1.0 / (p.b_top - b);
      g0 += w * top;
      h00 += w * top * top;
      // the ends may not be faster than they were
      if (n == 0 || n + 1 == points_.size()) {
        const double v = n == 0 ? r_.v_begin : r_.v_end, i = 1.0 / (v * v - b);
        g0 += w * i;
        h00 += w * i * i;
      }
      for (int axis = 0; axis < kJoints; ++axis) {
        const double l0 = p.j0[axis], l1 = p.j1[axis], l2 = p.j2[axis];
        if (l0 == 0.0 && l1 == 0.0 && l2 == 0.0) continue;
        const double L = l0 * x[0] + l1 * x[1] + l2 * x[2];
        if (std::abs(L) < kIdle * r) continue;
        const double i1 = 1.0 / (r - L), i2 = 1.0 / (r + L);
        const double difference = w * (i2 - i1), square = w * (i1 * i1 + i2 * i2);
        const double cross = difference * (i1 + i2) * r_b;
        g0 -= w * r_b * (i1 + i2) + difference * l0;
        g1 -= difference * l1;
        g2 -= difference * l2;
        h00 += square * (r_b * r_b + l0 * l0) + 2.0 * cross * l0;
        h01 += square * l0 * l1 + cross * l1;
        h02 += square * l0 * l2 + cross * l2;
        h11 += square * l1 * l1;
        h12 += square * l1 * l2;
        h22 += square * l2 * l2;
      }
      for (int axis = 0; axis < kJoints; ++axis) {
        const double m0 = p.a0[axis], m1 = p.a1[axis];
        const double M = m0 * x[0] + m1 * x[1];
        if (std::abs(M) < kIdle) continue;
        const double k1 = 1.0 / (1.0 - M), k2 = 1.0 / (1.0 + M);
        const double d = w * (k2 - k1), q = w * (k1 * k1 + k2 * k2);
        g0 -= d * m0;
        g1 -= d * m1;
        h00 += q * m0 * m0;
        h01 += q * m0 * m1;
        h11 += q * m1 * m1;
      }
      // to the coefficients: x = S(y) P c
      Eigen::Matrix3d S = intervals_[k].P;
      S.row(0) += p.y * (S.row(1) + 0.5 * p.y * S.row(2));
      S.row(1) += p.y * S.row(2);
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t row = free_coefficient(k + i);
        if (row < first || row >= last) continue;
        const auto I = static_cast<int>(i);
        const double a0 = S(0, I), a1 = S(1, I), a2 = S(2, I);
        step_[row] -= g0 * a0 + g1 * a1 + g2 * a2;
        const double u0 = h00 * a0 + h01 * a1 + h02 * a2, u1 = h01 * a0 + h11 * a1 + h12 * a2;
        const double u2 = h02 * a0 + h12 * a1 + h22 * a2;
        for (std::size_t j = i; j < 3; ++j) {
          const std::size_t column = free_coefficient(k + j);
          if (column >= last) continue;
          const auto J = static_cast<int>(j);
          const double both = column == row && j != i ? 2.0 : 1.0;
          band_[row][column - row] += both * (u0 * S(0, J) + u1 * S(1, J) + u2 * S(2, J));
        }
      }
    }
  }
  // c_0 = c_1 and c_N+1 = c_N
  std::size_t free_coefficient(std::size_t i) const { return std::clamp(i, std::size_t{1}, N_); }

  // L D L^T of five diagonals, in place.
  void solve(std::size_t first, std::size_t last) {
    for (std::size_t k = first; k < last; ++k) {
      auto& row = band_[k];
      const double inverse = 1.0 / row[0];
      for (std::size_t i = 1; i < 3 && k + i < last; ++i) {
        const double L = row[i] * inverse;
        for (std::size_t j = i; j < 3; ++j) band_[k + i][j - i] -= L * row[j];
        step_[k + i] -= L * step_[k];
      }
      for (double& x : row) x *= inverse;
      row[0] = inverse;
    }
    for (std::size_t k = last; k-- > first;) {
      step_[k] *= band_[k][0];
      for (std::size_t i = 1; i < 3 && k + i < last; ++i) step_[k] -= band_[k][i] * step_[k + i];
    }
  }

  // Largest loss of a slack, of the slack, in a whole step.
  double largest_loss(std::size_t from, std::size_t to) const {
    double loss = 1e-9;
    for (std::size_t n = from; n < to; ++n) {
      const Point& p = points_[n];
      const Vector3 x = shifted(state(p.interval, c_), p.y);
      const Vector3 d = shifted(state(p.interval, step_), p.y);
      const double b = x[0], r = 1.0 / std::sqrt(b), dr = -0.5 * r / b * d[0];
      loss = std::max({loss, -d[0] / b, d[0] / (p.b_top - b)});
      if (n == 0) loss = std::max(loss, d[0] / (r_.v_begin * r_.v_begin - b));
      if (n + 1 == points_.size()) loss = std::max(loss, d[0] / (r_.v_end * r_.v_end - b));
      for (int axis = 0; axis < kJoints; ++axis) {
        const double L = p.j0[axis] * x[0] + p.j1[axis] * x[1] + p.j2[axis] * x[2];
        const double dL = p.j0[axis] * d[0] + p.j1[axis] * d[1] + p.j2[axis] * d[2];
        if (std::abs(dL) - dr > loss * (r - std::abs(L))) {
          loss = std::max({loss, (dL - dr) / (r - L), (-dL - dr) / (r + L)});
        }
        const double M = p.a0[axis] * x[0] + p.a1[axis] * x[1];
        const double dM = p.a0[axis] * d[0] + p.a1[axis] * d[1];
        if (std::abs(dM) > loss * (1.0 - std::abs(M))) {
          loss = std::max({loss, dM / (1.0 - M), -dM / (1.0 + M)});
        }
      }
    }
    return loss;
  }

  // Factor on the speed with which every limit holds everywhere.
  double slow_down() const {
    double k = 1.0;
    for (std::size_t n = 0; n + 2 < points_.size(); n += 3) {
      const Point &p = points_[n], &q = points_[n + 2];
      const Vector3 x = state(p.interval, c_);
      const double jerk = largest_use(p, q, x, 0.0, 1.0, 0);
      k = std::min(k, std::cbrt(1.0 / std::max(jerk * kMargin, 1e-9)));
      // acceleration is quadratic, too: the control point in the middle
      const double y = 0.5 * (p.y + q.y);
      const Vector3 x0 = shifted(x, p.y), xm = shifted(x, y), x1 = shifted(x, q.y);
      const Joints M0 = p.a0 * x0[0] + p.a1 * x0[1], M1 = q.a0 * x1[0] + q.a1 * x1[1];
      const Joints Mm = 0.5 * (p.a0 + q.a0) * xm[0] + middle(p, q) * xm[1];
      const double a = std::max({M0.cwiseAbs().maxCoeff(), M1.cwiseAbs().maxCoeff(),
                                 (2.0 * Mm - 0.5 * (M0 + M1)).cwiseAbs().maxCoeff()});
      k = std::min(k, std::sqrt(1.0 / std::max(a * kMargin, 1e-9)));
      const double b = std::max({x0[0], x1[0], x0[0] + 0.5 * (q.y - p.y) * x0[1]});
      k = std::min(k, std::sqrt(p.b_top / b));
    }
    return k;
  }
  // a1 in the middle: q' is quadratic with second derivative q'''
  Joints middle(const Point& p, const Point& q) const {
    const double h = q.y - p.y;
    const Joints dda = 0.5 * path_.pieces[p.piece].c3.cwiseQuotient(limits_.a * kMargin);
    return 0.5 * (p.a1 + q.a1) - dda * (h * h / 8.0);
  }

  // Bound of |jerk| / (margin J) between fractions f and g of the way from p to q.
  double largest_use(const Point& p, const Point& q, const Vector3& x, double f, double g,
                     int depth) const {
    const double h = q.y - p.y;
    const auto jerk = [&](double z, double& b) -> Joints {
      const Vector3 at = shifted(x, p.y + z * h);
      b = at[0];
      const Joints j2 = p.j2 + z * h * (p.j1 / 3.0 + (0.25 * z * h) * p.j0);
      return p.j0 * at[0] + (p.j1 + (1.5 * z * h) * p.j0) * at[1] + j2 * at[2];
    };
    double b0 = 0.0, bm = 0.0, b1 = 0.0;
    const Joints L0 = jerk(f, b0), Lm = jerk(0.5 * (f + g), bm), L1 = jerk(g, b1);
    const double top = std::sqrt(std::max({b0, b1, 2.0 * bm - 0.5 * (b0 + b1)}));
    const double L = std::max({L0.cwiseAbs().maxCoeff(), L1.cwiseAbs().maxCoeff(),
                               (2.0 * Lm - 0.5 * (L0 + L1)).cwiseAbs().maxCoeff()});
    if (L * top * kMargin <= 1.0 || depth == kHalvings) return L * top;
    const double m = 0.5 * (f + g);
    return std::max(largest_use(p, q, x, f, m, depth + 1), largest_use(p, q, x, m, g, depth + 1));
  }

  double duration(std::size_t k) const {
    const Vector3 x = state(k, c_);
    const double h = t_[k + 1] - t_[k];
    const double v0 = std::sqrt(x[0]), v1 = std::sqrt(shifted(x, h)[0]);
    const double beta = 0.5 * x[2], r = h / (v0 + v1), z = beta * r * r;
    if (std::abs(z) < 1e-3) {
      return 2.0 * r * (1.0 + z * (1.0 / 3.0 + z * (0.2 + z * (1.0 / 7.0 + z / 9.0))));
    }
    const double root = std::sqrt(std::abs(beta));
    return 2.0 / root * (beta > 0.0 ? std::atanh(root * r) : std::atan(root * r));
  }

  bool write(double k, TimeLaw& out) const {
    const double v_a = std::sqrt(c_[1]) * k, v_b = std::sqrt(c_[N_]) * k;
    // The ramps before and behind go with it; beyond rounding they cannot be made quicker.
    constexpr double kRounding = 1e-12;
    if (v_a > r_.v_begin * (1.0 + kRounding) || v_b > r_.v_end * (1.0 + kRounding)) return false;
    const double slower_a = std::min(v_a / r_.v_begin, 1.0);
    const double slower_b = std::min(v_b / r_.v_end, 1.0);
    out.phases.clear();
    const auto scaled = [](Phase p, double t0, double out_t0, double f) {
      p.t = out_t0 + (p.t - t0) / f;
      p.v *= f;
      p.a *= f * f;
      p.j *= f * f * f;
      return p;
    };
    for (std::size_t i = 0; i < r_.first; ++i) {
      out.phases.push_back(scaled(law_.phases[i], 0.0, 0.0, slower_a));
    }
    double t = r_.t_begin / slower_a;
    for (std::size_t i = 0; i < N_; ++i) {
      const Vector3 x = state(i, c_);
      Phase p;
      p.t = t;
      p.s = t_[i];
      p.v = std::sqrt(x[0]) * k;
      p.a = 0.5 * x[1] * k * k;
      p.beta = 0.5 * x[2] * k * k;
      out.phases.push_back(p);
      t += duration(i) / k;
    }
    for (std::size_t i = r_.last; i < law_.phases.size(); ++i) {
      out.phases.push_back(scaled(law_.phases[i], r_.t_end, t, slower_b));
    }
    out.duration = t + (law_.duration - r_.t_end) / slower_b;
    return out.duration < law_.duration;
  }

  const TimeLaw& law_;
  const SmoothPath& path_;
  std::span<const double> v_top_;
  const JointLimits& limits_;
  Region r_;
  std::size_t N_ = 0, first_piece_ = 0;
  std::vector<double> t_;
  std::vector<Interval> intervals_;
  std::vector<Point> points_;
  std::vector<double> slack_weight_;
  std::vector<double> c_, step_;
  std::vector<std::size_t> first_points_;  // of each interval, and the end
  std::vector<std::array<double, 3>> band_;
};

}  // namespace

TimeLaw quicken(TimeLaw law, const SmoothPath& path, std::span<const double> v_top,
                const JointLimits& limits) {
  TimeLaw quicker;
  return Quickener(law, path, v_top, limits).run(quicker) ? quicker : law;
}

}  // namespace servomill::controllers

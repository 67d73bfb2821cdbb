#include "controllers/path/fair_spline.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "controllers/path/band.h"
#include "plant/vocabulary/interrupt.h"

namespace servomill::controllers {
namespace {

constexpr double kKnotSpacing = 0.55;  // of the window
constexpr double kKappa = 1.0 / 2.2;   // of (1), which halves waves of 2.2 rad in a window
constexpr double kAim = 0.9;           // of the tolerance, where a vertex is missed
constexpr double kMaxRaise = 16.0;     // of mu at once
constexpr double kBendAim = 0.7;       // of the third derivative that leaves the programmed speed
constexpr double kMinFactor = 0.8, kMaxFactor = 2.0;  // of its weight at once
constexpr int kBendRounds = 5;                        // in which bends are spread
constexpr int kMaxRounds = 12;                        // in all
constexpr std::size_t kMinIntervals = 7;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::size_t kExtra = 3;  // knots beyond each end

// q, q', q'', q''' at knot t[0] from the coefficients of the four B-splines between t[0] and t[1].
Eigen::Matrix4d basis_at(const double* t) {
  const double a1 = 3.0 / (t[1] - t[-2]), a2 = 3.0 / (t[2] - t[-1]), a3 = 3.0 / (t[3] - t[0]);
  const double b2 = 2.0 / (t[1] - t[-1]), b3 = 2.0 / (t[2] - t[0]), h = 1.0 / (t[1] - t[0]);
  using Row = Eigen::Matrix<double, 1, 4>;
  const Row d1(-a1, a1, 0.0, 0.0), d2(0.0, -a2, a2, 0.0), d3(0.0, 0.0, -a3, a3);
  const Row e2 = b2 * (d2 - d1), e3 = b3 * (d3 - d2);
  const double before = t[0] - t[-1], after = t[1] - t[0], both = t[1] - t[-1];
  const double first = after * after / (both * (t[1] - t[-2]));
  const double third = before * before / (both * (t[2] - t[-1]));
  Eigen::Matrix4d Q;
  Q.row(0) << first, 1.0 - first - third, third, 0.0;
  Q.row(1) = (after * d1 + before * d2) / both;
  Q.row(2) = e2;
  Q.row(3) = h * (e3 - e2);
  return Q;
}

double square_ratio(const Joints& D, const Polyline::Traits& v) {
  const double linear = D.head<kLinearJoints>().squaredNorm();
  const double rotary = D.tail<kJoints - kLinearJoints>().squaredNorm();
  if (std::isnan(linear + rotary)) return kInfinity;  // the system had no solution
  return std::max(linear / (v.tolerance_linear * v.tolerance_linear),
                  rotary / (v.tolerance_rotary * v.tolerance_rotary));
}

}  // namespace

bool FairSpline::fit(const Polyline& v, std::span<const double> s, std::span<const double> w,
                     const Joints& jerk, const State& begin, const State& end) {
  v_ = &v, s_ = s, w_ = w;
  jerk_ = jerk;
  begin_ = begin, end_ = end;
  lay_knots();
  if (N_ < kMinIntervals) return false;
  form_intervals();
  gather();
  set_ends();
  for (int round = 0; round < kMaxRounds; ++round) {
    throw_if_interrupted();
    solve();
    if (round < kBendRounds) {
      deviations();
      raise_weights();
      spread_bends();
      continue;
    }
    if (deviations()) {
      write();
      if (is_within_tolerance()) return true;
    }
    raise_weights();
  }
  return false;
}

// Knots at equal steps of the integral of ds / w.
void FairSpline::lay_knots() {
  const std::size_t from = begin_.chord, to = end_.chord;  // vertices from+1 .. to lie inside
  const double w_begin = w_[from + 1], w_end = w_[to];
  const auto walk = [&](auto&& step) {
    double at = begin_.s, w_at = w_begin;
    for (std::size_t i = from + 1; i <= to; ++i) {
      if (s_[i] > at) step(at, s_[i], 0.5 * (w_at + w_[i]));
      at = std::max(at, s_[i]), w_at = w_[i];
    }
    if (end_.s > at) step(at, end_.s, 0.5 * (w_at + w_end));
  };
  double sum = 0.0;
  walk([&](double a, double b, double w) { sum += (b - a) / w; });
  N_ = static_cast<std::size_t>(std::ceil(sum / kKnotSpacing));
  if (N_ < kMinIntervals) return;
  t_.clear();
  w_t_.clear();
  t_.resize(kExtra);
  t_.push_back(begin_.s);
  w_t_.push_back(w_begin);
  const double step = sum / static_cast<double>(N_);
  double done = 0.0;
  walk([&](double a, double b, double w) {
    const double here = (b - a) / w;
    for (double next = step * static_cast<double>(w_t_.size());
         next <= done + here && w_t_.size() < N_; next = step * static_cast<double>(w_t_.size())) {
      t_.push_back(a + (next - done) * w);
      w_t_.push_back(w);
    }
    done += here;
  });
  t_.push_back(end_.s);
  assert(t_.size() == N_ + 1 + kExtra && w_t_.size() == N_);
  for (std::size_t k = 1; k <= kExtra; ++k) {
    t_[kExtra - k] = 2.0 * begin_.s - t_[kExtra + k];
  }
  for (std::size_t k = 1; k <= kExtra; ++k) {
    t_.push_back(2.0 * end_.s - t_[kExtra + N_ - k]);
  }
}

void FairSpline::form_intervals() {
  intervals_.resize(N_);
  c_.resize(N_ + 3);
  const double* t = &t_[kExtra];
  for (std::size_t k = 0; k < N_; ++k) {
    Interval& I = intervals_[k];
    I.Q = basis_at(t + k);
    const double width = kKappa * w_t_[k], square = width * width;
    const double rho = square * square * square * (t[k + 1] - t[k]);
    std::size_t n = 0;
    for (int i = 0; i < 4; ++i) {
      for (int j = i; j < 4; ++j) I.F[n++] = rho * I.Q(3, i) * I.Q(3, j);
    }
    I.G.fill(0.0);
    I.R.setZero();
    I.mu = 1.0;
  }
}

void FairSpline::gather() {
  const double* t = &t_[kExtra];
  const std::size_t from = begin_.chord, to = end_.chord;
  points_.resize(to - from);
  std::size_t k = 0;
  intervals_[0].first = from + 1;
  for (std::size_t i = from + 1; i <= to; ++i) {
    while (k + 1 < N_ && s_[i] >= t[k + 1]) {
      intervals_[k].last = i;
      intervals_[++k].first = i;
    }
    Interval& I = intervals_[k];
    const double x = s_[i] - t[k];
    const Row B = I.Q.row(0) + x * (I.Q.row(1) + (0.5 * x) * (I.Q.row(2) + (x / 3.0) * I.Q.row(3)));
    const double l = 0.5 * (s_[i + 1] - s_[i - 1]);
    std::size_t n = 0;
    for (int a = 0; a < 4; ++a) {
      for (int b = a; b < 4; ++b) I.G[n++] += l * B[a] * B[b];
      I.R.row(a) += (l * B[a]) * v_->u(i).transpose();
    }
    points_[i - from - 1].B = {B[0], B[1], B[2], B[3]};
  }
  for (intervals_[k].last = to + 1; k + 1 < N_;) {
    ++k;
    intervals_[k].first = intervals_[k].last = to + 1;
  }
  // the speed is that of the slowest chord nearby
  const auto slowest = [&](std::size_t i) {
    const std::size_t a = intervals_[i > 0 ? i - 1 : 0].first;
    const std::size_t b = intervals_[std::min(i + 1, N_ - 1)].last;
    double v = v_->speed(std::min(b, to + 1));
    for (std::size_t n = a; n < b; ++n) v = std::min(v, v_->speed(n));
    return v;
  };
  for (std::size_t i = 0; i < N_; ++i) {
    const double v = slowest(i);
    intervals_[i].cube = v * v * v;
  }
}

// The first and the last three coefficients follow from the states at the ends.
void FairSpline::set_ends() {
  const auto coefficients = [](const Eigen::Matrix4d& Q, const State& state) {
    Eigen::Matrix<double, 3, kJoints> values;
    values << state.q.transpose(), state.d1.transpose(), state.d2.transpose();
    Eigen::Matrix<double, 3, kJoints> c = Q.topLeftCorner<3, 3>().inverse() * values;
    return c;
  };
  const auto first = coefficients(intervals_[0].Q, begin_);
  const auto last = coefficients(basis_at(&t_[kExtra + N_]), end_);
  for (int i = 0; i < 3; ++i) {
    c_[static_cast<std::size_t>(i)] = first.row(i).transpose();
    c_[N_ + static_cast<std::size_t>(i)] = last.row(i).transpose();
  }
}

// Normal equations of (1), a band of seven diagonals, by L D L^T.
void FairSpline::solve() {
  band_.assign(N_ + 3, {0.0, 0.0, 0.0, 0.0});
  for (std::size_t k = 3; k < N_; ++k) c_[k].setZero();
  for (std::size_t k = 0; k < N_; ++k) {
    const Interval& I = intervals_[k];
    std::size_t n = 0;
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = i; j < 4; ++j, ++n) band_[k + i][j - i] += I.mu * I.G[n] + I.F[n];
      const std::size_t row = k + i;
      if (row >= 3 && row < N_) c_[row] += I.mu * I.R.row(static_cast<int>(i)).transpose();
    }
  }
  for (std::size_t k = 0; k < 3; ++k) {  // what is known goes to the right-hand side
    for (std::size_t i = 3; i <= k + 3 && i < N_; ++i) c_[i] -= band_[k][i - k] * c_[k];
    for (std::size_t i = std::max<std::size_t>(N_ + k - 3, 3); i < N_; ++i) {
      c_[i] -= band_[i][N_ + k - i] * c_[N_ + k];
    }
  }
  solve_band(std::span(band_).subspan(3, N_ - 3), std::span(c_).subspan(3, N_ - 3));
}

// Are all vertices met?
bool FairSpline::deviations() {
  bool all = true;
  for (std::size_t k = 0; k < N_; ++k) {
    Interval& I = intervals_[k];
    I.worst = 0.0;
    for (std::size_t i = I.first; i < I.last; ++i) {
      const std::array<double, 4>& B = points_[i - begin_.chord - 1].B;
      const Joints q = B[0] * c_[k] + B[1] * c_[k + 1] + B[2] * c_[k + 2] + B[3] * c_[k + 3];
      I.worst = std::max(I.worst, square_ratio(q - v_->u(i), v_->traits(i)));
    }
    all = all && I.worst <= 1.0;
  }
  return all;
}

void FairSpline::raise_weights() {
  const auto factor = [&](std::size_t k) {
    const double over = intervals_[k].worst / (kAim * kAim);
    return std::clamp(over * over, 1.0, kMaxRaise);
  };
  double before = 1.0, here = factor(0);
  for (std::size_t k = 0; k < N_; ++k) {
    const double after = k + 1 < N_ ? factor(k + 1) : 1.0;
    intervals_[k].mu *= std::max({here, std::sqrt(before), std::sqrt(after)});
    before = here, here = after;
  }
}

// More weight on the third derivative where the programmed speed cannot be kept, less elsewhere.
void FairSpline::spread_bends() {
  double sum = 0.0;
  for (std::size_t k = 0; k < N_; ++k) {
    Interval& I = intervals_[k];
    const Joints bend =
        I.Q(3, 0) * c_[k] + I.Q(3, 1) * c_[k + 1] + I.Q(3, 2) * c_[k + 2] + I.Q(3, 3) * c_[k + 3];
    I.bend = bend.cwiseAbs().cwiseQuotient(jerk_).maxCoeff() * I.cube;
    sum += I.bend;
  }
  const double aim = std::max(kBendAim, kBendAim * sum / static_cast<double>(N_));
  for (Interval& I : intervals_) {
    const double factor = std::clamp(I.bend / aim, kMinFactor, kMaxFactor);
    for (double& x : I.F) x *= factor;
  }
}

void FairSpline::write() {
  pieces_.resize(N_);
  std::size_t chord = begin_.chord;
  for (std::size_t k = 0; k < N_; ++k) {
    CubicPiece& p = pieces_[k];
    const Eigen::Matrix4d& Q = intervals_[k].Q;
    const auto row = [&](int i) -> Joints {
      return Q(i, 0) * c_[k] + Q(i, 1) * c_[k + 1] + Q(i, 2) * c_[k + 2] + Q(i, 3) * c_[k + 3];
    };
    p.s = t_[kExtra + k];
    p.c0 = row(0), p.c1 = row(1), p.c2 = row(2), p.c3 = row(3);
    while (chord < end_.chord && s_[chord + 1] <= p.s) ++chord;
    p.segment = chord;
  }
}

// The deviation is a cubic on each part of a chord: within the hull of its control points.
bool FairSpline::is_within_tolerance() {
  bool all = true;
  for (std::size_t k = 0; k < N_; ++k) {
    const CubicPiece& p = pieces_[k];
    const double to = t_[kExtra + k + 1];
    double from = p.s;
    for (std::size_t i = p.segment; from < to; ++i) {
      const double end = i < end_.chord ? std::min(s_[i + 1], to) : to;
      const Joints d = (v_->u(i + 1) - v_->u(i)) / (s_[i + 1] - s_[i]);
      const double x = from - p.s, h = end - from;
      const Joints D0 =
          p.c0 + x * (p.c1 + (0.5 * x) * (p.c2 + (x / 3.0) * p.c3)) - v_->u(i) - (from - s_[i]) * d;
      const Joints D1 = p.c1 + x * (p.c2 + (0.5 * x) * p.c3) - d;
      const Joints D2 = p.c2 + x * p.c3;
      const Joints b1 = D0 + (h / 3.0) * D1, b2 = b1 + (h / 3.0) * (D1 + (0.5 * h) * D2);
      const Joints b3 = D0 + h * (D1 + (0.5 * h) * (D2 + (h / 3.0) * p.c3));
      double worst = 0.0;
      for (const Joints& b : {D0, b1, b2, b3})
        worst = std::max(worst, square_ratio(b, v_->traits(i + 1)));
      intervals_[k].worst = std::max(intervals_[k].worst, worst);
      all = all && worst <= 1.0;
      from = end;
    }
  }
  return all;
}

FairSpline::State FairSpline::state_at(std::size_t piece) const {
  const CubicPiece& p = pieces_[piece];
  return {p.s, p.c0, p.c1, p.c2, p.segment};
}

}  // namespace servomill::controllers

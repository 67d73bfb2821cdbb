#include "controllers/path/quicken.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "controllers/path/band.h"
#include "controllers/path/barrier_kernel.h"
#include "plant/vocabulary/interrupt.h"

namespace servomill::controllers {
namespace {

constexpr double kMargin = 0.99;   // of jerk and acceleration, for what lies between points
constexpr double kFirstMu = 5e-3;  // of the time that a point stands for
constexpr double kLastMu = 1e-4;
constexpr double kFall = 0.5;           // of mu, after a pass whose steps were not too short:
constexpr double kShortStep = 0.2;      // of the Newton step, mean of a pass
constexpr std::size_t kPasses = 12;     // four more gain 0.3 %
constexpr std::size_t kBlock = 64;      // coefficients that move together
constexpr double kFraction = 0.9;       // of a slack that one step may use
constexpr double kFirstScale = 0.81;    // of v^2, where the search begins
constexpr double kLeastScale = 0.01;    // below it there is nothing to gain
constexpr double kLongest = 8e-3;       // s, an interval
constexpr double kShortest = 3e-3;      // s, an interval
constexpr double kLeastLength = 1e-12;  // m, for which a point stands
constexpr double kLeastSpeed = 1e-6;    // m/s
constexpr std::size_t kLeast = 4;       // intervals
constexpr int kHalvings = 3;            // of an interval, to bound the jerk between points

static_assert(kBarrierJoints == kJoints);

using Vector3 = Eigen::Vector3d;  // b, b', b''

BarrierKernel barrier_kernel() {
  return at_simd_level(simd_level(),
                       []<SimdLevel level>() { return make_barrier_kernel<level>(); });
}

class Quickener {
 public:
  Quickener(const TimeLaw& law, const SmoothPath& path, std::span<const double> v_top,
            const JointLimits& limits)
      : law_(law),
        path_(path),
        v_top_(v_top),
        per_jerk_((limits.j * kMargin).cwiseInverse()),
        ratio_(limits.j.cwiseQuotient(limits.a)) {}

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
  struct Part {  // of one interval and one piece; with three points: both ends and the middle
    std::size_t interval = 0, piece = 0;
    double from = 0.0, to = 0.0;  // m
  };
  // (1) at a point, divided by J: j0 b + j1 b' + j2 b''; the acceleration follows from j1 and j2.
  struct Form {
    Joints j0, j1, j2;
    Form shifted(double x) const {
      return {j0, j1 + (1.5 * x) * j0, j2 + x * (j1 / 3.0 + (0.25 * x) * j0)};
    }
    Joints jerk(const Vector3& x) const { return j0 * x[0] + j1 * x[1] + j2 * x[2]; }
    Joints acceleration(const Vector3& x, const Joints& ratio) const {
      return ratio.cwiseProduct((2.0 / 3.0 * x[0]) * j1 + x[1] * j2);
    }
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

  Form form_at(std::size_t piece, double s) const {
    const CubicPiece& q = path_.pieces[piece];
    const double x = s - q.s;
    const Joints q1 = q.c1 + x * (q.c2 + 0.5 * x * q.c3), q2 = q.c2 + x * q.c3;
    return {q.c3.cwiseProduct(per_jerk_), 1.5 * q2.cwiseProduct(per_jerk_),
            0.5 * q1.cwiseProduct(per_jerk_)};
  }

  void find_moving_joints() {
    std::array<bool, kJoints> moves{};
    for (std::size_t i = first_piece_; i < path_.pieces.size(); ++i) {
      const CubicPiece& q = path_.pieces[i];
      for (int k = 0; k < kJoints; ++k) {
        moves[static_cast<std::size_t>(k)] |= q.c1[k] != 0.0 || q.c2[k] != 0.0 || q.c3[k] != 0.0;
      }
    }
    for (int k = 0; k < kJoints; ++k) {
      if (!moves[static_cast<std::size_t>(k)]) continue;
      joints_.ratio[joints_.count] = ratio_[k];
      moving_[joints_.count++] = k;
    }
  }

  void place_points() {
    std::size_t piece = first_piece_;
    for (std::size_t k = 0; k < N_; ++k) {
      first_points_.push_back(3 * parts_.size());
      for (double at = t_[k]; at < t_[k + 1];) {
        while (piece + 1 < path_.pieces.size() && path_.end_of(piece) <= at) ++piece;
        parts_.push_back({k, piece, at, std::min(path_.end_of(piece), t_[k + 1])});
        at = parts_.back().to;
      }
    }
    first_points_.push_back(3 * parts_.size());
    find_moving_joints();
    points_.resize(blocks_of(3 * parts_.size()));
    std::size_t n = 0;
    for (const Part& part : parts_) {
      const double h = part.to - part.from;
      const Form begin = form_at(part.piece, part.from), middle = begin.shifted(0.5 * h);
      put(n++, part, part.from, h / 6.0, begin, 0.0);
      // the control point of (1), a quadratic in s, is L_m - h^2 L''/8 with L'' = 4.5 q''' b''
      const double swell = 4.5 * h * h / 8.0;
      put(n++, part, 0.5 * (part.from + part.to), h * (2.0 / 3.0),
          {middle.j0, middle.j1, middle.j2 - swell * middle.j0}, swell);
      put(n++, part, part.to, h / 6.0, begin.shifted(h), 0.0);
    }
    fill_last_block(n);
    band_.resize(N_ + 2);
    terms_.resize(points_.size());
  }

  void put(std::size_t n, const Part& part, double s, double length, const Form& form,
           double swell) {
    BarrierPoints& to = points_[n / kLaneWidth];
    const std::size_t lane = n % kLaneWidth;
    Eigen::Matrix3d S = intervals_[part.interval].P;
    const double y = s - t_[part.interval];
    S.row(0) += y * (S.row(1) + 0.5 * y * S.row(2));
    S.row(1) += y * S.row(2);
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        to.S[i][j][lane] = S(static_cast<int>(i), static_cast<int>(j));
      }
    }
    to.length[lane] = std::max(length, kLeastLength);
    to.b_top[lane] = v_top_[part.piece] * v_top_[part.piece];
    to.swell[lane] = swell;
    to.interval[lane] = static_cast<std::uint32_t>(part.interval);
    for (std::size_t k = 0; k < joints_.count; ++k) {
      to.j0[k][lane] = form.j0[moving_[k]];
      to.j1[k][lane] = form.j1[moving_[k]];
      to.j2[k][lane] = form.j2[moving_[k]];
    }
  }

  // What is left of it repeats the last point; nobody reads the terms.
  void fill_last_block(std::size_t n) {
    const Part& part = parts_.back();
    const Form end = form_at(part.piece, part.to);
    for (; n < points_.size() * kLaneWidth; ++n) put(n, part, part.to, 0.0, end, 0.0);
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
    const BarrierUse use = kernel_.use(points_.data(), points_.size(), joints_, c_.data());
    if (!(use.b_least > 0.0)) return false;
    const double v_a = r_.v_begin, v_b = r_.v_end;
    const double scale = std::min({kFirstScale, 0.98 * v_a * v_a / c_[1], 0.98 * v_b * v_b / c_[N_],
                                   0.9 * std::pow(use.jerk, -2.0 / 3.0),
                                   0.9 / std::max(use.acceleration, 1e-12), 0.9 / use.speed});
    for (double& c : c_) c *= scale;
    time_scale_ = 1.0 / std::sqrt(scale);
    return scale > kLeastScale;
  }

  void optimise() {
    step_.assign(N_ + 2, 0.0);
    double mu = kFirstMu;
    for (std::size_t pass = 0; pass < kPasses; ++pass) {
      // other blocks in every pass, so that none has a lasting border
      const std::size_t shift = kBlock / 4 * (pass % 4 + 1);
      double steps = 0.0, blocks = 0.0;
      for (std::size_t i = 1; i <= N_; blocks += 1.0) {
        throw_if_interrupted();
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
    const std::size_t from = first < 3 ? 0 : first - 2, to = std::min(last, N_);  // intervals
    const std::size_t block = first_points_[from] / kLaneWidth;
    const std::size_t count = blocks_of(first_points_[to]) - block;
    kernel_.derive(&points_[block], count, joints_, c_.data(), mu * time_scale_, &terms_[block]);
    assemble(mu, first, last, from, to);
    solve_band(std::span(band_).subspan(first, last - first),
               std::span(step_).subspan(first, last - first));
    if (first == 1) step_[0] = step_[1];
    if (last == N_ + 1) step_[N_ + 1] = step_[N_];
    const double loss = std::max(
        kernel_.largest_loss(&points_[block], count, joints_, step_.data(), &terms_[block]),
        largest_loss_at_ends());
    const double alpha = std::min(1.0, kFraction / loss);
    for (std::size_t i = first; i < last; ++i) {
      c_[i] += alpha * step_[i];
      step_[i] = 0.0;
    }
    tie_ends();
    step_[0] = step_[N_ + 1] = 0.0;
    return alpha;
  }

  // Derivatives of (2) by the coefficients first..last-1 from the points of the intervals.
  void assemble(double mu, std::size_t first, std::size_t last, std::size_t from, std::size_t to) {
    for (std::size_t i = first; i < last; ++i) {
      band_[i] = {0.0, 0.0, 0.0};
      step_[i] = 0.0;
    }
    for (std::size_t k = from; k < to; ++k) {
      std::array<double, 3> g{};
      std::array<double, 6> h{};
      for (std::size_t n = first_points_[k]; n < first_points_[k + 1]; ++n) {
        const BarrierTerms& terms = terms_[n / kLaneWidth];
        const std::size_t lane = n % kLaneWidth;
        for (std::size_t i = 0; i < 3; ++i) g[i] += terms.g[i][lane];
        for (std::size_t i = 0; i < 6; ++i) h[i] += terms.h[i][lane];
      }
      if (k == 0) add_end(0, r_.v_begin, mu, g, h);
      if (k + 1 == N_) add_end(3 * parts_.size() - 1, r_.v_end, mu, g, h);
      std::size_t n = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t row = free_coefficient(k + i);
        const bool is_free = row >= first && row < last;
        if (is_free) step_[row] -= g[i];
        for (std::size_t j = i; j < 3; ++j, ++n) {
          const std::size_t column = free_coefficient(k + j);
          if (!is_free || column >= last) continue;
          band_[row][column - row] += (column == row && j != i ? 2.0 : 1.0) * h[n];
        }
      }
    }
  }
  // The ends may not be faster than they were.
  void add_end(std::size_t n, double v, double mu, std::array<double, 3>& g,
               std::array<double, 6>& h) const {
    const BarrierPoints& p = points_[n / kLaneWidth];
    const std::size_t lane = n % kLaneWidth;
    const double slack = v * v - terms_[n / kLaneWidth].x[0][lane];
    const double g0 = mu * time_scale_ * p.time[lane] / slack, h00 = g0 / slack;
    std::size_t m = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      g[i] += g0 * p.S[0][i][lane];
      for (std::size_t j = i; j < 3; ++j) h[m++] += h00 * p.S[0][i][lane] * p.S[0][j][lane];
    }
  }
  // c_0 = c_1 and c_N+1 = c_N: the speed at the ends is that of the outermost coefficients
  std::size_t free_coefficient(std::size_t i) const { return std::clamp(i, std::size_t{1}, N_); }
  double largest_loss_at_ends() const {
    return std::max(step_[1] / (r_.v_begin * r_.v_begin - c_[1]),
                    step_[N_] / (r_.v_end * r_.v_end - c_[N_]));
  }

  // Factor on the speed with which every limit holds everywhere.
  double slow_down() const {
    double jerk = 1e-9, acceleration = 1e-9, speed = 1e-9;  // uses; the last of b
    for (const Part& part : parts_) {
      const Form form = form_at(part.piece, part.from);
      const Vector3 x = shifted(state(part.interval, c_), part.from - t_[part.interval]);
      const double h = part.to - part.from;
      jerk = std::max(jerk, largest_jerk(form, x, 0.0, h, 0));
      const auto [a, b] = largest_acceleration(form, x, h);
      acceleration = std::max(acceleration, a);
      speed = std::max(speed, b / (v_top_[part.piece] * v_top_[part.piece]));
    }
    return std::min({1.0, std::cbrt(1.0 / (jerk * kMargin)),
                     std::sqrt(1.0 / (acceleration * kMargin)), std::sqrt(1.0 / speed)});
  }

  // Bounds by the control points of a quadratic.
  static double largest(const Joints& from, const Joints& middle, const Joints& to) {
    const Joints control = 2.0 * middle - 0.5 * (from + to);
    return from.cwiseAbs().cwiseMax(control.cwiseAbs()).cwiseMax(to.cwiseAbs()).maxCoeff();
  }
  // Of a quadratic itself: its vertex if that lies between.
  static double largest(double from, double middle, double to) {
    const double control = 2.0 * middle - 0.5 * (from + to), end = std::max(from, to);
    if (control <= end) return end;
    return (control * control - from * to) / (2.0 * control - from - to);
  }

  // Bounds of |acceleration| / (margin A) and of b over h metres from where `form` and `x` are.
  std::pair<double, double> largest_acceleration(const Form& form, const Vector3& x,
                                                 double h) const {
    const Vector3 xm = shifted(x, 0.5 * h), x1 = shifted(x, h);
    return {largest(form.acceleration(x, ratio_), form.shifted(0.5 * h).acceleration(xm, ratio_),
                    form.shifted(h).acceleration(x1, ratio_)),
            largest(x[0], xm[0], x1[0])};
  }

  // Bound of |jerk| / (margin J) between f and g metres from there.
  static double largest_jerk(const Form& form, const Vector3& x, double f, double g, int depth) {
    const double m = 0.5 * (f + g);
    const Vector3 x0 = shifted(x, f), xm = shifted(x, m), x1 = shifted(x, g);
    const double top = std::sqrt(largest(x0[0], xm[0], x1[0]));
    const double L =
        largest(form.shifted(f).jerk(x0), form.shifted(m).jerk(xm), form.shifted(g).jerk(x1));
    if (L * top * kMargin <= 1.0 || depth == kHalvings) return L * top;
    return std::max(largest_jerk(form, x, f, m, depth + 1), largest_jerk(form, x, m, g, depth + 1));
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
  Joints per_jerk_, ratio_;  // 1/(margin J); J/A
  BarrierKernel kernel_ = barrier_kernel();
  Region r_;
  std::size_t N_ = 0, first_piece_ = 0;
  std::vector<double> t_;
  std::vector<Interval> intervals_;
  std::vector<Part> parts_;
  std::vector<BarrierPoints> points_;
  std::vector<std::size_t> first_points_;  // of each interval, and the end
  BarrierJoints joints_;
  std::array<int, kJoints> moving_{};  // the joints in `joints_`
  double time_scale_ = 1.0;            // of the points' times, by the speed the search begins with
  std::vector<double> c_, step_;
  std::vector<BarrierTerms> terms_;
  std::vector<std::array<double, 3>> band_;
};

}  // namespace

TimeLaw quicken(TimeLaw law, const SmoothPath& path, std::span<const double> v_top,
                const JointLimits& limits) {
  TimeLaw quicker;
  if (Quickener(law, path, v_top, limits).run(quicker)) return quicker;
  return law;
}

}  // namespace servomill::controllers

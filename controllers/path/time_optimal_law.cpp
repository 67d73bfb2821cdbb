#include "controllers/path/time_optimal_law.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "controllers/path/band.h"
#include "controllers/path/barrier_kernel.h"
#include "controllers/path/barrier_store.h"
#include "controllers/path/law_ends.h"
#include "controllers/path/limit_use.h"
#include "controllers/path/path_parts.h"
#include "controllers/path/speed_spline.h"
#include "plant/vocabulary/interrupt.h"

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
constexpr double kFirstScale = 0.81;  // of v^2, where the search begins
constexpr double kMinScale = 0.01;    // below it there is nothing to gain
constexpr double kLongest = 8e-3;     // s, an interval
constexpr double kShortest = 3e-3;    // s, an interval
constexpr double kMinSpeed = 1e-6;    // m/s
constexpr std::size_t kMin = 4;       // intervals
constexpr std::size_t kPartsAtOnce = 512;

static_assert(kBarrierJoints == kJoints);

BarrierKernel barrier_kernel() {
  return at_simd_level(simd_level(),
                       []<SimdLevel level>() { return make_barrier_kernel<level>(); });
}

class Refinement {
 public:
  Refinement(const TimeLaw& law, const SmoothPath& path, std::span<const double> v_top,
             const JointLimits& limits, const LawEnds& ends)
      : law_(law),
        ends_(ends),
        path_(path),
        v_top_(v_top),
        per_jerk_((limits.j * kMargin).cwiseInverse()),
        ratio_(limits.j.cwiseQuotient(limits.a)) {}

  bool run(TimeLaw& out) {
    if (!find_region()) return false;
    lay_knots();
    if (N_ < kMin) return false;
    parts_.lay(path_, t_, first_piece_);
    find_moving_joints();
    start();
    if (!scale_into_limits()) return false;
    optimise();
    return write(slow_down(), out);
  }

 private:
  // Between the first and the last instant at which the speed neither rises nor falls.
  bool find_region() {
    const auto begin = ends_.begin(), end = begin ? ends_.end() : std::nullopt;
    if (!end || end->s <= begin->s) return false;
    begin_ = *begin, end_ = *end;
    return true;
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
    return std::max(p.v + t * (p.a + 0.5 * t * p.j), kMinSpeed);
  }

  // Knots where pieces meet, unless they are short; long pieces are divided.
  void lay_knots() {
    t_.assign(1, begin_.s);
    std::size_t phase = begin_.phase, i = 0;
    while (path_.end_of(i) <= begin_.s) ++i;
    first_piece_ = i;
    double v_from = begin_.v;
    for (; t_.back() < end_.s; ++i) {
      const double from = t_.back(), to = std::min(path_.end_of(i), end_.s);
      const double v_to = speed_at(to, phase);
      const double time = (to - from) / std::min(v_from, v_to);
      if (to < end_.s && time < kShortest) continue;
      const int n = std::max(1, static_cast<int>(std::ceil(time / kLongest)));
      for (int k = 1; k < n; ++k) t_.push_back(from + (to - from) * k / n);
      t_.push_back(to);
      v_from = v_to;
    }
    N_ = t_.size() - 1;
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
      joints_.per_jerk[joints_.count] = per_jerk_[k];
      moving_[joints_.count++] = k;
    }
  }

  void start() {
    c_.resize(N_ + 2);
    std::size_t phase = begin_.phase;
    for (std::size_t i = 1; i <= N_; ++i) {
      const double v = speed_at(0.5 * (t_[i - 1] + t_[i]), phase);
      c_[i] = v * v;
    }
    tie_ends();
    first_c_ = c_;
    step_.assign(N_ + 2, 0.0);
    points_.prepare(joints_, moving_, kernel_);
  }
  void tie_ends() {
    c_[0] = c_[1];
    c_[N_ + 1] = c_[N_];
  }

  // Lowers b as a whole until all slacks are positive.
  bool scale_into_limits() {
    BarrierUse use = {std::numeric_limits<double>::infinity(), 0.0, 0.0, 0.0};
    for (std::size_t first = 0; first < parts_.size(); first += kPartsAtOnce) {
      throw_if_interrupted();
      const auto at = points_.of(first, std::min(first + kPartsAtOnce, parts_.size()));
      const BarrierUse here = kernel_.use(at.points, at.count, joints_, c_.data());
      use = {std::min(use.b_least, here.b_least), std::max(use.jerk, here.jerk),
             std::max(use.acceleration, here.acceleration), std::max(use.speed, here.speed)};
    }
    if (!(use.b_least > 0.0)) return false;
    const double v_a = begin_.v, v_b = end_.v;
    const double scale = std::min({kFirstScale, 0.98 * v_a * v_a / c_[1], 0.98 * v_b * v_b / c_[N_],
                                   0.9 * std::pow(use.jerk, -2.0 / 3.0),
                                   0.9 / std::max(use.acceleration, 1e-12), 0.9 / use.speed});
    for (double& c : c_) c *= scale;
    time_scale_ = 1.0 / std::sqrt(scale);
    return scale > kMinScale;
  }

  void optimise() {
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
    const auto at = points_.of(parts_.first_of(from), parts_.first_of(to));
    if (terms_.size() < at.count) terms_.resize(at.count);
    kernel_.derive(at.points, at.count, joints_, c_.data(), mu * time_scale_, terms_.data());
    assemble(mu, first, last, at);
    const std::span<double> step = std::span(step_).subspan(first, last - first);
    solve_band(std::span(band_), step);
    if (first == 1) step_[0] = step_[1];
    if (last == N_ + 1) step_[N_ + 1] = step_[N_];
    const double loss =
        std::max(kernel_.largest_loss(at.points, at.count, joints_, step_.data(), terms_.data()),
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

  // Derivatives of (2) by the coefficients first..last-1 from the points of the intervals that they
  // form.
  void assemble(double mu, std::size_t first, std::size_t last, const BarrierStore::Blocks& at) {
    band_.assign(last - first, {0.0, 0.0, 0.0});
    std::fill_n(step_.begin() + static_cast<std::ptrdiff_t>(first), last - first, 0.0);
    for (std::size_t k = first < 3 ? 0 : first - 2; k < std::min(last, N_); ++k) {
      Derivatives of = sum_over(k, at);
      if (k == 0) add_end(0, begin_.v, mu, at, of.g, of.h);
      if (k + 1 == N_) add_end(3 * parts_.size() - 1, end_.v, mu, at, of.g, of.h);
      add_interval(k, of, first, last);
    }
  }

  // By the three coefficients of an interval; second ones 00 01 02 11 12 22.
  struct Derivatives {
    std::array<double, 3> g{};
    std::array<double, 6> h{};
  };
  Derivatives sum_over(std::size_t interval, const BarrierStore::Blocks& at) const {
    Derivatives of;
    const std::size_t end = 3 * parts_.first_of(interval + 1);
    for (std::size_t n = 3 * parts_.first_of(interval); n < end; ++n) {
      const BarrierTerms& terms = terms_[n / kLaneWidth - at.first];
      const std::size_t lane = n % kLaneWidth;
      for (std::size_t i = 0; i < 3; ++i) of.g[i] += terms.g[i][lane];
      for (std::size_t i = 0; i < 6; ++i) of.h[i] += terms.h[i][lane];
    }
    return of;
  }
  void add_interval(std::size_t k, const Derivatives& of, std::size_t first, std::size_t last) {
    std::size_t n = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t row = free_coefficient(k + i);
      const bool is_free = row >= first && row < last;
      if (is_free) step_[row] -= of.g[i];
      for (std::size_t j = i; j < 3; ++j, ++n) {
        const std::size_t column = free_coefficient(k + j);
        if (!is_free || column >= last) continue;
        band_[row - first][column - row] += (column == row && j != i ? 2.0 : 1.0) * of.h[n];
      }
    }
  }
  // The ends may not be faster than they were.
  void add_end(std::size_t n, double v, double mu, const BarrierStore::Blocks& at,
               std::array<double, 3>& g, std::array<double, 6>& h) const {
    const BarrierPoints& p = at.holding(n);
    const std::size_t lane = n % kLaneWidth;
    const double slack = v * v - terms_[n / kLaneWidth - at.first].x[0][lane];
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
    return std::max(step_[1] / (begin_.v * begin_.v - c_[1]),
                    step_[N_] / (end_.v * end_.v - c_[N_]));
  }

  // Factor on the speed with which every limit holds everywhere.
  double slow_down() const {
    const LimitUse use = largest_use(path_, b_, parts_, v_top_, per_jerk_, ratio_, kMargin);
    return std::min({1.0, std::cbrt(1.0 / (use.jerk * kMargin)),
                     std::sqrt(1.0 / (use.acceleration * kMargin)), std::sqrt(1.0 / use.speed)});
  }

  bool write(double k, TimeLaw& out) const {
    const auto before = ends_.before(begin_, std::sqrt(c_[1]) * k);
    const auto behind = ends_.behind(end_, std::sqrt(c_[N_]) * k);
    if (!before || !behind) return false;
    out.phases.clear();
    out.phases.reserve(before->phases.size() + N_ + behind->phases.size());
    out.phases.insert(out.phases.end(), before->phases.begin(), before->phases.end());
    double t = before->duration;
    for (std::size_t i = 0; i < N_; ++i) {
      const SpeedSpline::State x = b_.begin_of(i);
      Phase p;
      p.t = t;
      p.s = t_[i];
      p.v = std::sqrt(x[0]) * k;
      p.a = 0.5 * x[1] * k * k;
      p.beta = 0.5 * x[2] * k * k;
      out.phases.push_back(p);
      t += b_.duration(i, x) / k;
    }
    for (Phase phase : behind->phases) {
      phase.t += t;
      out.phases.push_back(phase);
    }
    out.duration = t + behind->duration;
    return out.duration < law_.duration;
  }

  const TimeLaw& law_;
  const LawEnds& ends_;
  const SmoothPath& path_;
  std::span<const double> v_top_;
  Joints per_jerk_, ratio_;  // 1/(margin J); J/A
  BarrierKernel kernel_ = barrier_kernel();
  LawEnds::Place begin_, end_;
  std::size_t N_ = 0, first_piece_ = 0;
  SpeedSpline b_;
  std::vector<double>&t_ = b_.t, &c_ = b_.c;
  std::vector<double> first_c_;  // where the search begins
  PathParts parts_;
  BarrierJoints joints_;
  std::array<int, kJoints> moving_{};  // the joints in `joints_`
  BarrierStore points_{path_, b_, parts_, v_top_, first_c_};
  double time_scale_ = 1.0;  // of the points' times, by the speed the search begins with
  std::vector<double> step_;
  // of one block
  std::vector<BarrierTerms> terms_;
  std::vector<std::array<double, 3>> band_;
};

}  // namespace

TimeLaw refine_time_law(TimeLaw law, const SmoothPath& path, std::span<const double> v_top,
                        const JointLimits& limits, std::span<const SegmentLimits> stretches,
                        const EndSpeeds& speeds) {
  TimeLaw quicker;
  const LawEnds ends(law, stretches, speeds);
  if (Refinement(law, path, v_top, limits, ends).run(quicker)) return quicker;
  return law;
}

}  // namespace servomill::controllers

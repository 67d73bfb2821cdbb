#include "plant/drives/exact_step.h"

#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

#include "plant/drives/drive_rates.h"

namespace servomill::plant {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Sub-steps down to a base period over 2^26: 0.15 ps of 10 us.
constexpr int kMaxHalvings = 26;
constexpr double kNewtonShare = 0.02;  // of the tolerance
constexpr double kNoTravel = 1e-14;    // m: a reversal that moves less in a sub-step is none

template <std::size_t n>
void add(std::array<double, n>& sum, const std::array<double, n>& column, double factor) {
  for (std::size_t row = 0; row < n; ++row) sum[row] += column[row] * factor;
}

}  // namespace

ExactStep::ExactStep(const FeedDriveParams& params, double base_period, Tick longest_step,
                     const Resolution& resolution)
    : params_(params), resolution_(resolution), sub_ticks_(halvings_of(params, base_period)) {
  assert(sub_ticks_ <= kMaxHalvings);
  finest_ = std::ldexp(base_period, -sub_ticks_);
  const double longest =
      std::min({static_cast<double>(longest_step) * base_period, resolution.longest,
                PropagatorSeries<5>::kMaxRate / fastest_rate_of(params)});
  const int coarsest =
      std::max(0, static_cast<int>(std::floor(std::log2(longest / finest_) + 1e-9)));
  const bool may_stick = params.friction.kind == FrictionKind::set_valued;
  const bool may_part = params.gap > 0.0;
  for (const bool gap : {false, true}) {
    for (const bool sticking : {false, true}) {
      if ((gap && !may_part) || (sticking && !may_stick)) continue;
      linear_index_[2 * gap + sticking] = static_cast<int>(linear_.size());
      prepare(sticking, gap, coarsest);
    }
  }
  if (params.is_linear() && params.on_bed()) prepare_held();
  const FrictionParams& f = params.friction;
  // Newton's iteration squares a correction, relative to the speed over which friction bends.
  double bend = f.kind == FrictionKind::regularised ? std::min(f.v0, f.vs) : f.vs;
  if (f.kind == FrictionKind::lugre) {
    bend = std::min(bend, least_force(f) / (f.sigma0 * longest));
  }
  const double speed_error =
      kNewtonShare * std::min(resolution.tolerance, kSolverTolerance) / kMemory;
  speed_tolerance_ = std::sqrt(bend * speed_error);
  has_kink_ = f.kind == FrictionKind::lugre ||
              (f.kind == FrictionKind::regularised &&
               (f.Fs_positive != f.Fs_negative || f.Fc_positive != f.Fc_negative ||
                f.b_positive > 0.0 || f.b_negative > 0.0));
  gliding_ = gliding_of(params);
}

void ExactStep::prepare(bool sticking, bool gap, int coarsest) {
  Linear& mode = linear_.emplace_back();
  const auto length = [&](int level) {
    return std::ldexp(static_cast<long double>(finest_), level);
  };
  if (params_.on_bed()) {
    mode.on_bed = drive_equations_on_bed(params_, sticking, gap);
    const PropagatorSeries<7> series(mode.on_bed);
    for (int level = 0; level <= coarsest; ++level) {
      mode.ladder.push_back(series.over(length(level)));
      mode.bed.push_back(series.bed_over(length(level)));
    }
    return;
  }
  mode.A = drive_equations(params_, sticking, gap);
  const PropagatorSeries<5> series(mode.A);
  for (int level = 0; level <= coarsest; ++level) {
    mode.ladder.push_back(series.over(length(level)));
  }
}

bool ExactStep::sticks(const LaneState& s) const {
  return params_.friction.kind == FrictionKind::set_valued && s.slide == SlideMode::sticking;
}

const ExactStep::Linear& ExactStep::linear_of(const LaneState& s) const {
  const bool apart = params_.gap > 0.0 && s.contact == ContactMode::gap;
  return linear_[static_cast<std::size_t>(linear_index_[2 * apart + sticks(s)])];
}

double ExactStep::friction_force(const LaneState& s) const {
  const FrictionParams& p = params_.friction;
  switch (p.kind) {
    case FrictionKind::none:
      return 0.0;
    case FrictionKind::set_valued: {
      // at v = 0 the mode knows the direction, else the speed
      const bool positive = s.v == 0.0 ? s.slide == SlideMode::positive : s.v > 0.0;
      return (positive ? 1.0 : -1.0) * sliding_force(p, positive, s.v);
    }
    case FrictionKind::regularised:
      return regularised_force(p, s.v);
    case FrictionKind::lugre:
      return bristle_force(p, s.v, s.z);
  }
  return 0.0;
}

double ExactStep::force(const LaneState& s, double F) const {
  return params_.F_load + F + friction_force(s) + cogging_force(params_, s.x);
}

// The rows of a propagator, times a factor for each column.
struct ExactStep::Rows {
  std::array<double, Propagator::kSlideRows> slide{};
  std::array<double, Propagator::kInnerRows> inner{};
  bool looks_within;  // the inner rows are wanted, too

  // @param P  Propagator or BedPropagator
  template <class P>
  void add(const P& propagator, std::size_t column, double factor) {
    plant::add(slide, propagator.slide[column], factor);
    if (looks_within) plant::add(inner, propagator.inner[column], factor);
  }
};

// Returns true if states within a sub-step matter: for breakaway, for the flanks, for cogging.
bool ExactStep::looks_within(const LaneState& s) const {
  return sticks(s) || params_.gap > 0.0 || params_.cogging.T != 0.0;
}

BristleForces<double> ExactStep::friction_at(const LaneState& s, double h,
                                             const double (&v)[2]) const {
  const FrictionParams& p = params_.friction;
  switch (p.kind) {
    case FrictionKind::none:
      break;
    case FrictionKind::set_valued: {
      const double way = direction(s.slide);
      const ForceSlope half = sliding(p, way > 0.0, v[0]), end = sliding(p, way > 0.0, v[1]);
      return {{way * half.value, way * end.value},
              {way * half.slope, 0.0, 0.0, way * end.slope},
              {},
              {}};
    }
    case FrictionKind::regularised: {
      const NodeForces<double> at = regularised_at(p, v);
      return {{at.f[0], at.f[1]}, {at.df.a, 0.0, 0.0, at.df.d}, {}, {}};
    }
    case FrictionKind::lugre:
      return bristles_at(p, s.z, bristle_rate(p, s.v, s.z), h, v);
  }
  return {};
}

// Newton's iteration for the speeds at h/2 and h. y holds the response to all but the force there.
bool ExactStep::collocate(const LaneState& s, double F, double h, const Propagator& P, Rows& y,
                          Trial& trial) const {
  constexpr std::size_t kRow[2] = {1, 3};  // of v at h/2 and h
  constexpr int kMaxIterations = 12;
  const double f0 = force(s, F);
  y.add(P, 5, f0);
  const auto& at_half = P.slide[6];
  const auto& at_end = P.slide[7];
  const Matrix2<double> C = {at_half[kRow[0]], at_end[kRow[0]], at_half[kRow[1]], at_end[kRow[1]]};
  double f[2] = {f0, f0}, v[2], dv[2];
  const auto response = [&](std::size_t j) {
    return y.slide[kRow[j]] + at_half[kRow[j]] * f[0] + at_end[kRow[j]] * f[1];
  };
  for (std::size_t j = 0; j < 2; ++j) v[j] = response(j);
  const double load = params_.F_load + F;
  for (int n = 0; n < kMaxIterations; ++n) {
    double cogging[2] = {};
    if (params_.cogging.T != 0.0) {
      constexpr std::size_t kHalf = 4 * 1 + 3, kEnd = Propagator::kPosition;
      cogging[0] = cogging_force(
          params_, s.x + y.inner[kHalf] + P.inner[6][kHalf] * f[0] + P.inner[7][kHalf] * f[1]);
      cogging[1] =
          cogging_force(params_, s.x + y.slide[kEnd] + at_half[kEnd] * f[0] + at_end[kEnd] * f[1]);
    }
    BristleForces<double> at = friction_at(s, h, v);
    for (std::size_t j = 0; j < 2; ++j) f[j] = load + cogging[j] + at.f[j];
    const double residual[2] = {response(0) - v[0], response(1) - v[1]};
    newton(C, at.df, residual, dv);
    for (std::size_t j = 0; j < 2; ++j) v[j] += dv[j];
    follow(f, at.df, dv);
    const double change = std::max(std::abs(dv[0]), std::abs(dv[1]));
    if (change <= speed_tolerance_ + 1e-13 * std::abs(v[1])) {
      y.add(P, 6, f[0]);
      y.add(P, 7, f[1]);
      const double forces[3] = {f0, f[0], f[1]};
      std::copy(std::begin(forces), std::end(forces), trial.f);
      if (params_.friction.kind == FrictionKind::lugre) {
        trial.dz[0] = bristle_rate(params_.friction, s.v, s.z);
        follow(at.rate, at.drate, dv);
        trial.dz[1] = at.rate[0];
        trial.dz[2] = at.rate[1];
        for (std::size_t node = 0; node < kNodes; ++node) {
          trial.at[node].z = s.z + h * parabola(kIntegral[node], trial.dz);
        }
      }
      return true;
    }
    if (!(change < kInfinity)) return false;
  }
  return false;
}

// Error of the parabola at h/4 and 3h/4, as the displacement (m) that it causes.
double ExactStep::error_of(double F, double h, const Trial& trial) const {
  const LaneState& first = trial.at[0];
  const LaneState& third = trial.at[2];
  const double impulse = h / params_.slide_mass();
  double error = missed(force(first, F), force(third, F), trial.f, impulse * h, impulse * kMemory);
  if (params_.friction.kind == FrictionKind::lugre) {
    error += missed(bristle_rate(params_.friction, first.v, first.z),
                    bristle_rate(params_.friction, third.v, third.z), trial.dz, h, h);
  }
  return error;
}

// Returns true if a state, reached without a change of mode, belongs to another mode.
bool ExactStep::happens(const LaneState& s, double F) const {
  if (params_.friction.kind == FrictionKind::set_valued) {
    if (s.slide == SlideMode::sticking) {
      if (slide_from_rest(params_.friction, driving_force(params_, s, F)) != s.slide) return true;
    } else if (direction(s.slide) * s.v < 0.0) {
      return true;
    }
  }
  return params_.gap > 0.0 && contact_after(params_, s) != s.contact;
}

ExactStep::Trial ExactStep::attempt(const LaneState& s, double command, double F,
                                    std::size_t level) const {
  const Linear& linear = linear_of(s);
  const Propagator& P = linear.ladder[level];
  const double h = std::ldexp(finest_, static_cast<int>(level));
  const double offset = contact_offset(params_, s.contact);
  Trial trial;
  trial.at.fill(s);
  Rows y{.looks_within = looks_within(s)};
  const double start[] = {s.i, s.w, s.delta - offset, s.v, command};
  for (std::size_t column = 0; column < 5; ++column) y.add(P, column, start[column]);
  if (params_.on_bed()) {
    y.add(linear.bed[level], 0, s.bed_x);
    y.add(linear.bed[level], 1, s.bed_v);
  }
  const bool slides = !sticks(s);
  if (slides && !collocate(s, F, h, P, y, trial)) {
    trial.error = kInfinity;
    return trial;
  }
  if (params_.on_bed()) move_bed(linear.bed[level], start, s, trial);
  for (std::size_t node = 0; node < kNodes; ++node) {
    LaneState& at = trial.at[node];
    const bool last = node + 1 == kNodes;
    at.v = y.slide[node];
    if (last || y.looks_within) {
      const double* row = last ? &y.slide[Propagator::kCurrent] : &y.inner[4 * node];
      at.i = row[0];
      at.w = row[1];
      at.delta = offset + row[2];
      at.x = s.x + row[3];
    }
    if (trial.event == kNone && happens(at, F)) trial.event = node;
    const double before = node == 0 ? s.v : trial.at[node - 1].v;
    if (has_kink_ && trial.kink == kNone && before * at.v < 0.0 && std::abs(at.v) * h > kNoTravel) {
      trial.kink = node;
    }
  }
  if (slides && std::min(trial.event, trial.kink) == kNone && resolution_.tolerance < kInfinity) {
    trial.error = error_of(F, h, trial);
  }
  return trial;
}

// The bed, once the force against the slide is known.
void ExactStep::move_bed(const BedPropagator& P, const double (&start)[5], const LaneState& s,
                         Trial& trial) {
  const double in[] = {start[0],   start[1],   start[2],   start[3], start[4],
                       trial.f[0], trial.f[1], trial.f[2], s.bed_x,  s.bed_v};
  std::array<double, 2 * kNodes> bed{};
  for (std::size_t column = 0; column < BedPropagator::kColumns; ++column) {
    plant::add(bed, P.bed[column], in[column]);
  }
  for (std::size_t node = 0; node < kNodes; ++node) {
    trial.at[node].bed_x = bed[2 * node];
    trial.at[node].bed_v = bed[2 * node + 1];
  }
}

// Finds the mode of friction that states are set to.
void ExactStep::find_slide_mode(LaneState& s, double F) const {
  if (params_.friction.kind != FrictionKind::set_valued) return;
  if (s.v == 0.0) {
    from_rest(s, F);
  } else {
    s.slide = s.v > 0.0 ? SlideMode::positive : SlideMode::negative;
  }
}

// Level after a sub-step of the wanted level: a longer one where the error leaves room.
int ExactStep::lengthened(int wanted, int coarsest, double error) const {
  if (!(error * 64.0 <= resolution_.tolerance)) return wanted;
  return std::min(wanted + (error * 4096.0 <= resolution_.tolerance ? 2 : 1), coarsest);
}

void ExactStep::advance(LaneState& s, double command, double F, Tick step) const {
  assert(step > 0);
  if (params_.current_is_command()) s.i = command;
  if (!held_.empty()) return advance_held(s, command, params_.F_load + F, step << sub_ticks_);
  find_slide_mode(s, F);
  const int coarsest = static_cast<int>(linear_.front().ladder.size()) - 1;
  int wanted = std::clamp(coarsest - s.control.halvings, 0, coarsest);
  for (std::int64_t rest = step << sub_ticks_; rest > 0;) {
    const int fits = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(rest))) - 1;
    const int level = std::min(wanted, fits);
    const Trial trial = attempt(s, command, F, static_cast<std::size_t>(level));
    const bool resolved = trial.error <= resolution_.tolerance && trial.error < kInfinity;
    const std::size_t stop = std::min(trial.event, trial.kink);
    if (level > 0 && (stop != kNone || !resolved)) {
      constexpr int kHalvings[] = {3, 2, 1, 1, 1};  // to before the stop
      wanted = std::max(level - kHalvings[stop], 0);
      continue;
    }
    rest -= std::int64_t{1} << level;
    const StepControl control = s.control;
    if (trial.event != kNone) {
      cross(s, command, F);
    } else {
      s = trial.error < kInfinity ? trial.at.back() : coast(s, command, F, finest_);
    }
    s.control = control;
    if (!resolved) ++s.control.unresolved;
    if (level == wanted) wanted = lengthened(wanted, coarsest, trial.error);
  }
  s.control.halvings = coarsest - wanted;
}

}  // namespace servomill::plant

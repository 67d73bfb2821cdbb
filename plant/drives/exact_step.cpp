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
constexpr int kMaxHalvings = 26;
constexpr double kNewtonShare = 0.02;  // of the tolerance
constexpr double kNoTravel = 1e-14;    // m: a reversal that moves less in a sub-step is none

double direction(SlideMode slide) { return slide == SlideMode::negative ? -1.0 : 1.0; }

// Fraction at which a straight line from a to b >= 0 reaches 0.
double rise(double a, double b) { return a >= 0.0 ? 0.0 : a / (a - b); }

template <std::size_t n>
void add(std::array<double, n>& sum, const std::array<double, n>& column, double factor) {
  for (std::size_t row = 0; row < n; ++row) sum[row] += column[row] * factor;
}

// A drive with cogging nowhere is linear, one with backlash may be but has events there, too.
Gliding gliding_of(const FeedDriveParams& p) {
  const FrictionParams& f = p.friction;
  if (p.cogging.T != 0.0 || p.gap > 0.0 || f.b_positive > 0.0 || f.b_negative > 0.0) return {};
  Gliding g{.speed = 0.0};
  if (f.kind == FrictionKind::none) return g;
  if (f.Fs_positive != f.Fc_positive || f.Fs_negative != f.Fc_negative) {
    g.speed = kStribeckEnd * f.vs;
  }
  if (f.kind == FrictionKind::regularised) g.speed = std::max(g.speed, kTanhEnd * f.v0);
  g.Fc_positive = f.Fc_positive;
  g.Fc_negative = f.Fc_negative;
  if (f.kind == FrictionKind::lugre) g.sigma0 = f.sigma0;
  return g;
}

}  // namespace

ExactStep::ExactStep(const FeedDriveParams& params, double base_period, Tick longest_step,
                     const Resolution& resolution)
    : params_(params), resolution_(resolution), sub_ticks_(halvings_of(params, base_period)) {
  assert(sub_ticks_ <= kMaxHalvings);
  finest_ = std::ldexp(base_period, -sub_ticks_);
  const double longest =
      std::min({static_cast<double>(longest_step) * base_period, resolution.longest,
                PropagatorSeries::kMaxRate / fastest_rate_of(params)});
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
  mode.A = drive_equations(params_, sticking, gap);
  const PropagatorSeries series(mode.A);
  for (int level = 0; level <= coarsest; ++level) {
    mode.ladder.push_back(series.over(std::ldexp(static_cast<long double>(finest_), level)));
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

  void add(const Propagator& P, std::size_t column, double factor) {
    for (std::size_t n = 0; n < slide.size(); ++n) slide[n] += P.slide[column][n] * factor;
    if (!looks_within) return;
    for (std::size_t n = 0; n < inner.size(); ++n) inner[n] += P.inner[column][n] * factor;
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
  const Propagator& P = linear_of(s).ladder[level];
  const double h = std::ldexp(finest_, static_cast<int>(level));
  const double offset = contact_offset(params_, s.contact);
  Trial trial;
  trial.at.fill(s);
  Rows y{.looks_within = looks_within(s)};
  const double start[] = {s.i, s.w, s.delta - offset, s.v, command};
  for (std::size_t column = 0; column < 5; ++column) y.add(P, column, start[column]);
  const bool slides = !sticks(s);
  if (slides && !collocate(s, F, h, P, y, trial)) {
    trial.error = kInfinity;
    return trial;
  }
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

// Over a time so short that two terms of the Taylor series do, in the mode of the start.
LaneState ExactStep::coast(const LaneState& s, double command, double F, double dt) const {
  const Equations& A = linear_of(s).A;
  Eigen::Matrix<double, 7, 1> y;
  const double offset = contact_offset(params_, s.contact);
  y << s.i, s.w, s.delta - offset, s.v, 0.0, command, sticks(s) ? 0.0 : force(s, F);
  const Eigen::Matrix<double, 5, 1> rate = A * y;
  const Eigen::Matrix<double, 5, 1> change = dt * rate + 0.5 * dt * dt * (A.leftCols<5>() * rate);
  LaneState next = s;
  next.i += change[0];
  next.w += change[1];
  next.delta += change[2];
  next.v += change[3];
  next.x += change[4];
  if (params_.friction.kind == FrictionKind::lugre) {
    next.z += dt * bristle_rate(params_.friction, s.v, s.z);
  }
  return next;
}

// The slide has stopped.
void ExactStep::from_rest(LaneState& s, double F) const {
  s.v = 0.0;
  if (params_.is_rigid()) s.w = 0.0;
  s.slide = slide_from_rest(params_.friction, driving_force(params_, s, F));
}

// Fraction of the step from s to end at which the slide stops or breaks away; 1: it does not.
double ExactStep::slide_event(const LaneState& s, const LaneState& end, double F) const {
  const FrictionParams& f = params_.friction;
  if (f.kind != FrictionKind::set_valued) return 1.0;
  if (sticks(s)) {
    const double D0 = driving_force(params_, s, F), D1 = driving_force(params_, end, F);
    if (D1 > f.Fs_positive) return rise(D0 - f.Fs_positive, D1 - f.Fs_positive);
    if (D1 < -f.Fs_negative) return rise(-D0 - f.Fs_negative, -D1 - f.Fs_negative);
    return 1.0;
  }
  const double v0 = direction(s.slide) * s.v, v1 = direction(s.slide) * end.v;
  return v1 < 0.0 ? rise(-v0, -v1) : 1.0;
}

// Fraction of the step at which a flank makes or loses contact; 1: it does not.
double ExactStep::contact_event(const LaneState& s, const LaneState& end) const {
  const ContactMode next = params_.gap > 0.0 ? contact_after(params_, end) : s.contact;
  if (next == s.contact) return 1.0;
  const ContactMode flank = next == ContactMode::gap ? s.contact : next;
  const double away = flank == ContactMode::positive ? 1.0 : -1.0;
  const double S0 = away * flank_force(params_, s, flank);
  const double S1 = away * flank_force(params_, end, flank);
  if (next == ContactMode::gap) return rise(-S0, -S1);
  const double offset = contact_offset(params_, flank);
  return std::max(rise(S0, S1), rise(away * (s.delta - offset), away * (end.delta - offset)));
}

// Through the finest sub-step, in which something happens: to the event, then on in the new mode.
void ExactStep::cross(LaneState& s, double command, double F) const {
  const LaneState end = coast(s, command, F, finest_);
  const double slide_at = slide_event(s, end, F), contact_at = contact_event(s, end);
  const double first = std::min(slide_at, contact_at);
  LaneState next = coast(s, command, F, first * finest_);
  if (first >= 1.0) {
    // it only grazed
  } else if (contact_at == first) {
    next.contact = contact_after(params_, end);
  } else if (sticks(s)) {
    const bool upwards = driving_force(params_, end, F) > params_.friction.Fs_positive;
    next.slide = upwards ? SlideMode::positive : SlideMode::negative;
  } else {
    from_rest(next, F);
  }
  s = coast(next, command, F, (1.0 - first) * finest_);
  const bool slides = params_.friction.kind == FrictionKind::set_valued && !sticks(s);
  if (slides && direction(s.slide) * s.v <= 0.0) from_rest(s, F);
}

void ExactStep::advance(LaneState& s, double command, double F, Tick step) const {
  assert(step > 0);
  if (params_.current_is_command()) s.i = command;
  if (params_.friction.kind == FrictionKind::set_valued) {
    if (s.v == 0.0) {
      from_rest(s, F);
    } else {
      s.slide = s.v > 0.0 ? SlideMode::positive : SlideMode::negative;
    }
  }
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
    if (level == wanted && wanted < coarsest && trial.error * 64.0 <= resolution_.tolerance) {
      wanted += trial.error * 4096.0 <= resolution_.tolerance ? 2 : 1;
      wanted = std::min(wanted, coarsest);
    }
  }
  s.control.halvings = coarsest - wanted;
}

}  // namespace servomill::plant

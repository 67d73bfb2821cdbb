#include "plant/drives/exact_step.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>

namespace servomill::plant {
namespace {

using Matrix4 = Eigen::Matrix4d;
using Matrix5l = Eigen::Matrix<long double, 5, 5>;
using Vector5l = Eigen::Matrix<long double, 5, 1>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kEventLength = 10e-9;  // s: events are located in a sub-step no longer than this
constexpr double kCoastRate = 1e-3;     // rate x finest sub-step: coast() is exact to its cube
constexpr double kFrictionRate = 1e-3;  // the same for the rates of friction, which are solved for
constexpr double kSeriesRate = 2.0;     // rate x coarsest sub-step: the series converges in kTerms
constexpr int kTerms = 30;              // 2^30 / 30! is below the last bit of long double
constexpr int kMostHalvings = 26;
constexpr double kMemory = 5e-3;  // s, for which the servo loop leaves an error of speed standing
constexpr double kNewtonShare = 0.02;  // of the tolerance
constexpr double kNoTravel = 1e-14;    // m: a reversal that moves less in a sub-step is none

// Similar to A with rows and columns of equal size (Osborne's iteration): the size of its entries
// is that of its eigenvalues.
Matrix4 balanced(Matrix4 A) {
  for (int sweep = 0; sweep < 30; ++sweep) {
    for (int j = 0; j < 4; ++j) {
      const double column = A.col(j).cwiseAbs().sum() - std::abs(A(j, j));
      const double row = A.row(j).cwiseAbs().sum() - std::abs(A(j, j));
      if (column == 0.0 || row == 0.0) continue;
      const double scale = std::sqrt(row / column);
      A.col(j) *= scale;
      A.row(j) /= scale;
    }
  }
  return A;
}

// Bound of the eigenvalues of a drive without its position (1/s). Rows or columns that couple one
// way only have no say.
double fastest_rate(const Eigen::Matrix<double, 5, 7>& A) {
  Matrix4 B = balanced(A.topLeftCorner<4, 4>());
  for (int j = 0; j < 4; ++j) {
    const double diagonal = B(j, j);
    B(j, j) = 0.0;
    if (B.row(j).cwiseAbs().sum() == 0.0 || B.col(j).cwiseAbs().sum() == 0.0) {
      B.row(j).setZero();
      B.col(j).setZero();
    }
    B(j, j) = diagonal;
  }
  return B.cwiseAbs().rowwise().sum().maxCoeff();
}

double fastest_rate(const FeedDriveParams& p) {
  double rate = fastest_rate(drive_equations(p, false, false));
  if (p.friction.kind == FrictionKind::set_valued) {
    rate = std::max(rate, fastest_rate(drive_equations(p, true, false)));
  }
  return rate;
}

// The rates (1/s) with which friction acts on the slide, each with what it is made of.
struct FrictionRate {
  double rate;
  const char* formula;
};
std::vector<FrictionRate> friction_rates(const FeedDriveParams& p) {
  const FrictionParams& f = p.friction;
  const double M = p.slide_mass();
  if (f.kind == FrictionKind::regularised) {
    return {{std::max(f.Fs_positive, f.Fs_negative) / (f.v0 * M),
             "the slope of the regularised friction, breakaway / (regularisation_velocity mass),"}};
  }
  if (f.kind == FrictionKind::lugre) {
    const double Fc = std::min(f.Fc_positive, f.Fc_negative);
    return {{std::sqrt(f.sigma0 / M), "the bristles' stiffness, sqrt(bristle_stiffness / mass),"},
            {f.sigma1 / M, "the bristles' damping, bristle_damping / mass,"},
            {f.sigma0 * kStribeckEnd * f.vs / Fc, "6.5 vs sigma0 / Fc"}};
  }
  return {};
}

// Halvings of the base period that give the finest sub-step.
int halvings_of(const FeedDriveParams& p, double base_period) {
  double finest = std::min(kEventLength, kCoastRate / fastest_rate(p));
  for (const FrictionRate& f : friction_rates(p)) finest = std::min(finest, kFrictionRate / f.rate);
  return std::max(0, static_cast<int>(std::ceil(std::log2(base_period / finest))));
}

// e^{At}, int_0^t e^{A(t-s)} b ds and int_0^t e^{A(t-s)} b_F s^m ds, m = 0, 1, 2, as power series.
class Series {
 public:
  struct Values {
    Matrix5l E = Matrix5l::Zero();
    Vector5l command = Vector5l::Zero();
    std::array<Vector5l, 3> moment = {Vector5l::Zero(), Vector5l::Zero(), Vector5l::Zero()};
  };

  explicit Series(const Eigen::Matrix<double, 5, 7>& equations) {
    const Matrix5l A = equations.leftCols<5>().cast<long double>();
    A_[0].setIdentity();
    for (std::size_t k = 1; k < kTerms; ++k) A_[k] = A * A_[k - 1];
    for (std::size_t k = 0; k < kTerms; ++k) {
      command_[k] = A_[k] * equations.col(5).cast<long double>();
      force_[k] = A_[k] * equations.col(6).cast<long double>();
    }
  }

  Values at(long double t) const {
    Values v;
    std::array<long double, 4> factor = {1.0L, t, t * t / 2.0L, t * t * t / 3.0L};
    for (std::size_t k = 0; k < kTerms; ++k) {
      const auto n = static_cast<long double>(k + 1);
      v.E += A_[k] * factor[0];
      v.command += command_[k] * factor[1];
      for (std::size_t m = 0; m < 3; ++m) v.moment[m] += force_[k] * factor[m + 1];
      for (std::size_t m = 0; m < 4; ++m) factor[m] *= t / (n + static_cast<long double>(m));
    }
    return v;
  }

 private:
  std::array<Matrix5l, kTerms> A_;
  std::array<Vector5l, kTerms> command_, force_;
};

// The parabolas that are 1 at one of 0, 1/2, 1 and 0 at the others: coefficients of 1, s, s^2.
constexpr double kLagrange[3][3] = {{1.0, -3.0, 2.0}, {0.0, 4.0, -4.0}, {0.0, -1.0, 2.0}};
// Their integrals from 0 to 1/4, 1/2, 3/4, 1, and their values at 1/4, 3/4.
constexpr double kIntegral[4][3] = {{1.0 / 6.0, 5.0 / 48.0, -1.0 / 48.0},
                                    {5.0 / 24.0, 1.0 / 3.0, -1.0 / 24.0},
                                    {3.0 / 16.0, 9.0 / 16.0, 0.0},
                                    {1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0}};
constexpr double kQuarter[2][3] = {{0.375, 0.75, -0.125}, {-0.125, 0.75, 0.375}};

double parabola(const double (&weight)[3], const std::array<double, 3>& value) {
  return weight[0] * value[0] + weight[1] * value[1] + weight[2] * value[2];
}

double direction(SlideMode slide) { return slide == SlideMode::negative ? -1.0 : 1.0; }

// Where a straight line from a to b >= 0 reaches 0, as a fraction.
double rise(double a, double b) { return a >= 0.0 ? 0.0 : a / (a - b); }

template <std::size_t n>
void add(std::array<double, n>& sum, const std::array<double, n>& column, double factor) {
  for (std::size_t row = 0; row < n; ++row) sum[row] += column[row] * factor;
}

// A drive with cogging nowhere is linear, one with backlash may be but has events there, too.
Gliding gliding_of(const FeedDriveParams& p) {
  const FrictionParams& f = p.friction;
  if (p.cogging.T != 0.0 || p.gap > 0.0) return {};
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
  assert(sub_ticks_ <= kMostHalvings);
  finest_ = std::ldexp(base_period, -sub_ticks_);
  const double longest = std::min({static_cast<double>(longest_step) * base_period,
                                   resolution.longest, kSeriesRate / fastest_rate(params)});
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
    bend = std::min(bend, std::min(f.Fc_positive, f.Fc_negative) / (f.sigma0 * longest));
  }
  const double speed_error = kNewtonShare * std::min(resolution.tolerance, 2e-12) / kMemory;
  speed_tolerance_ = std::sqrt(bend * speed_error);
  has_kink_ = f.kind == FrictionKind::lugre ||
              (f.kind == FrictionKind::regularised &&
               (f.Fs_positive != f.Fs_negative || f.Fc_positive != f.Fc_negative));
  gliding_ = gliding_of(params);
}

void ExactStep::prepare(bool sticking, bool gap, int coarsest) {
  Linear& mode = linear_.emplace_back();
  mode.A = drive_equations(params_, sticking, gap);
  const Series series(mode.A);
  mode.ladder.resize(static_cast<std::size_t>(coarsest) + 1);
  for (std::size_t level = 0; level < mode.ladder.size(); ++level) {
    const long double h = std::ldexp(static_cast<long double>(finest_), static_cast<int>(level));
    for (std::size_t node = 0; node < kNodes; ++node) {
      const Series::Values S = series.at(h * static_cast<long double>(node + 1) / 4.0L);
      for (std::size_t row = 0; row < kStates; ++row) {
        const auto r = static_cast<Eigen::Index>(row);
        const auto entry = [&](std::size_t column) -> double& {
          return mode.ladder[level][column][node * kStates + row];
        };
        for (std::size_t column = 0; column < 4; ++column) {
          entry(column) = static_cast<double>(S.E(r, static_cast<Eigen::Index>(column)));
        }
        entry(4) = static_cast<double>(S.command(r));
        for (std::size_t j = 0; j < 3; ++j) {
          const double(&l)[3] = kLagrange[j];
          entry(5 + j) = static_cast<double>(l[0] * S.moment[0](r) + l[1] * S.moment[1](r) / h +
                                             l[2] * S.moment[2](r) / (h * h));
        }
      }
    }
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

// The force against the slide at the nodes h/2 and h, and its derivative by the speeds there.
struct ExactStep::Forces {
  std::array<double, 2> f{}, rate{};  // N; dz/dt, m/s
  Eigen::Matrix2d df = Eigen::Matrix2d::Zero(), drate = Eigen::Matrix2d::Zero();
};

ExactStep::Forces ExactStep::forces_at(const LaneState& s, double F, double h,
                                       const std::array<double, 2>& v,
                                       const std::array<double, 2>& x) const {
  const FrictionParams& p = params_.friction;
  Forces out;
  if (p.kind == FrictionKind::lugre) {
    // dz/dt = v - a(v) z at the nodes, z by its collocation: linear in z
    const double rate0 = bristle_rate(p, s.v, s.z);
    Eigen::Matrix2d C;
    C << kIntegral[1][1], kIntegral[1][2], kIntegral[3][1], kIntegral[3][2];
    C *= h;
    Eigen::Vector2d a, slope;  // a(v), da/dv
    for (int j = 0; j < 2; ++j) {
      const double vj = v[static_cast<std::size_t>(j)];
      const ForceSlope g = sliding(p, vj >= 0.0, vj);
      a[j] = p.sigma0 * std::abs(vj) / g.value;
      slope[j] = p.sigma0 * (std::copysign(1.0, vj) - std::abs(vj) * g.slope / g.value) / g.value;
    }
    const Eigen::Vector2d V(v[0], v[1]);
    const Eigen::Vector2d known = Eigen::Vector2d::Constant(s.z) +
                                  h * rate0 * Eigen::Vector2d(kIntegral[1][0], kIntegral[3][0]) +
                                  C * V;
    const Eigen::Matrix2d inverse = (Eigen::Matrix2d::Identity() + C * a.asDiagonal()).inverse();
    const Eigen::Vector2d z = inverse * known;
    const Eigen::Matrix2d direct = (Eigen::Vector2d::Ones() - slope.cwiseProduct(z)).asDiagonal();
    const Eigen::Matrix2d dz = inverse * C * direct;
    const Eigen::Vector2d rate = V - a.cwiseProduct(z);
    const Eigen::Vector2d f = p.sigma0 * z + p.sigma1 * rate;
    out.f = {f[0], f[1]};
    out.rate = {rate[0], rate[1]};
    out.drate = direct - a.asDiagonal() * dz;
    out.df = p.sigma0 * dz + p.sigma1 * out.drate;
  } else {
    for (std::size_t j = 0; j < 2; ++j) {
      ForceSlope g = {0.0, 0.0};
      if (p.kind == FrictionKind::regularised) g = regularised(p, v[j]);
      if (p.kind == FrictionKind::set_valued) {
        g = sliding(p, s.slide == SlideMode::positive, v[j]);
        g = {direction(s.slide) * g.value, direction(s.slide) * g.slope};
      }
      out.f[j] = g.value;
      out.df(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(j)) = g.slope;
    }
  }
  for (std::size_t j = 0; j < 2; ++j) {
    out.f[j] += params_.F_load + F + cogging_force(params_, x[j]);
  }
  return out;
}

// Newton's iteration for the speeds at h/2 and h. y holds the response to all but the force there.
bool ExactStep::collocate(const LaneState& s, double F, double h, const Propagator& P, Rows& y,
                          Trial& trial) const {
  constexpr std::size_t kVelocity[2] = {kStates + 3, 3 * kStates + 3};
  constexpr std::size_t kPosition[2] = {kStates + 4, 3 * kStates + 4};
  constexpr int kMostIterations = 12;
  const double f0 = force(s, F);
  add(y, P[5], f0);
  std::array<double, 2> f = {f0, f0}, v{}, x{};
  Eigen::Matrix2d C;
  for (int j = 0; j < 2; ++j) {
    C(j, 0) = P[6][kVelocity[j]];
    C(j, 1) = P[7][kVelocity[j]];
  }
  const auto response = [&](std::size_t row) {
    return y[row] + P[6][row] * f[0] + P[7][row] * f[1];
  };
  for (std::size_t j = 0; j < 2; ++j) v[j] = response(kVelocity[j]);
  for (int n = 0; n < kMostIterations; ++n) {
    for (std::size_t j = 0; j < 2; ++j) x[j] = s.x + response(kPosition[j]);
    const Forces at = forces_at(s, F, h, v, x);
    f = at.f;
    const Eigen::Vector2d residual(response(kVelocity[0]) - v[0], response(kVelocity[1]) - v[1]);
    const Eigen::Matrix2d jacobian = Eigen::Matrix2d::Identity() - C * at.df;
    const Eigen::Vector2d dv = jacobian.inverse() * residual;
    const Eigen::Vector2d df = at.df * dv;
    for (std::size_t j = 0; j < 2; ++j) {
      v[j] += dv[static_cast<Eigen::Index>(j)];
      f[j] += df[static_cast<Eigen::Index>(j)];
    }
    const double change = dv.cwiseAbs().maxCoeff();
    if (change <= speed_tolerance_ + 1e-13 * std::abs(v[1])) {
      add(y, P[6], f[0]);
      add(y, P[7], f[1]);
      trial.f = {f0, f[0], f[1]};
      if (params_.friction.kind == FrictionKind::lugre) {
        const Eigen::Vector2d drate = at.drate * dv;
        trial.dz = {bristle_rate(params_.friction, s.v, s.z), at.rate[0] + drate[0],
                    at.rate[1] + drate[1]};
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

// What the parabola misses at h/4 and 3h/4, as the displacement (m) that it leaves. A cubic miss
// moves the slide only within the sub-step, a quartic one changes its speed. Factors: integrals of
// s (s - 1/2) (s - 1), times (1 - s), and of s (s - 1/2)^2 (s - 1), over their values at 1/4.
double ExactStep::error_of(double F, double h, const Trial& trial) const {
  constexpr double kCubic = 8.0 / 45.0, kQuartic = 32.0 / 45.0;
  const LaneState& first = trial.at[0];
  const LaneState& third = trial.at[2];
  const auto effect = [](double a, double b, const std::array<double, 3>& nodes, double cubic,
                         double quartic) {
    a -= parabola(kQuarter[0], nodes);
    b -= parabola(kQuarter[1], nodes);
    return 0.5 * (kCubic * cubic * std::abs(a - b) + kQuartic * quartic * std::abs(a + b));
  };
  const double impulse = h / params_.slide_mass();
  double error = effect(force(first, F), force(third, F), trial.f, impulse * h, impulse * kMemory);
  if (params_.friction.kind == FrictionKind::lugre) {
    error += effect(bristle_rate(params_.friction, first.v, first.z),
                    bristle_rate(params_.friction, third.v, third.z), trial.dz, h, h);
  }
  return error;
}

// Whether a state, reached without a change of mode, belongs to another mode.
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
  Rows y{};
  const double start[] = {s.i, s.w, s.delta - offset, s.v, command};
  for (std::size_t column = 0; column < 5; ++column) add(y, P[column], start[column]);
  const bool slides = !sticks(s);
  if (slides && !collocate(s, F, h, P, y, trial)) {
    trial.error = kInfinity;
    return trial;
  }
  for (std::size_t node = 0; node < kNodes; ++node) {
    LaneState& at = trial.at[node];
    const double* row = &y[node * kStates];
    at.i = row[0];
    at.w = row[1];
    at.delta = offset + row[2];
    at.v = row[3];
    at.x = s.x + row[4];
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

// Where on the way from s to end the slide stops or breaks away, as a fraction; 1: it does not.
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

// Where a flank takes hold or lets go, likewise.
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

std::vector<std::string> unrepresentable(const FeedDriveParams& p, double base_period) {
  constexpr double kLongestToFinest = 1000.0;  // sub-steps in a base period
  std::vector<std::string> faults;
  const double limit = kLongestToFinest / base_period;
  const auto demand = [&](double rate, const char* what) {
    if (rate <= limit) return;
    faults.push_back(
        fmt::format("{} makes a rate of {:.3g} 1/s; the exact step resolves up to {:.3g} 1/s", what,
                    rate, limit));
  };
  demand(fastest_rate(p), "the stiffness or damping of the drive");
  for (const FrictionRate& f : friction_rates(p)) demand(f.rate, f.formula);
  return faults;
}

}  // namespace servomill::plant

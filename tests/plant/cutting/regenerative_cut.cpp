#include "tests/plant/cutting/regenerative_cut.h"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>
#include <numbers>

namespace servomill::plant {
namespace {

constexpr double kFullTurn = 2.0 * std::numbers::pi;
constexpr int kIterations = 3;  // of a step's force, which depends on its end
constexpr int kPassages = 240;  // until the largest multiplier is left alone
constexpr int kFitted = 20;     // passages, from which it is taken
constexpr int kSearch = 20;
constexpr double kDepthTol = 1e-4;  // relative

// Share of the places [phi - half, phi + half] that is within [from, to].
double share_within(double phi, double half, double from, double to) {
  const double cut = std::min(phi + half, to) - std::max(phi - half, from);
  return std::clamp(cut / (2.0 * half), 0.0, 1.0);
}

}  // namespace

RegenerativeCut::RegenerativeCut(const SteadyCut& cut, const ChatterMode& mode, Chips chips,
                                 int steps)
    : cut_(cut), mode_(mode), chips_(chips), steps_(steps) {
  assert(steps >= 10 && cut.from >= 0.0 && cut.from < cut.to && cut.to <= kFullTurn / 2.0 + 1e-12);
  const int places = cut.teeth * steps;
  const double half = 0.5 * kFullTurn / places;
  for (int place = 0; place < places; ++place) {
    const double phi = kFullTurn * place / places, s = std::sin(phi), c = std::cos(phi);
    const Eigen::Vector2d r(s, c), t(c, -s);
    // a step about 0 begins below 0
    const double share = share_within(phi, half, cut.from, cut.to) +
                         share_within(phi - kFullTurn, half, cut.from, cut.to);
    angles_.push_back({share, r.dot(mode.direction), t.dot(mode.direction), cut.feed * s});
    if (share > 0.0) cutting_.push_back(place);
  }
  surface_.assign(angles_.size(), 0.0);
  // exact solution over a step, of an initial state and of forces 1 and t / dt
  const double dt = 1.0 / (cut.turns * places), w = mode.frequency, z = mode.damping;
  const double wd = w * std::sqrt(1.0 - z * z), e = std::exp(-z * w * dt);
  const double s = std::sin(wd * dt), c = std::cos(wd * dt);
  transition_[0][0] = e * (c + z * w / wd * s);
  transition_[0][1] = e * s / wd;
  transition_[1][0] = -e * w * w / wd * s;
  transition_[1][1] = e * (c - z * w / wd * s);
  const double k = mode.stiffness;
  const double step_q = (1.0 - transition_[0][0]) / k, step_dq = -transition_[1][0] / k;
  // of t / dt: q = (t - 2 z / w) / (k dt) from q0 = -2 z / (w k dt), dq0 = 1 / (k dt) on
  const double q0 = -2.0 * z / (w * k * dt), dq0 = 1.0 / (k * dt);
  rising_[0] = q0 + 1.0 / k - (transition_[0][0] * q0 + transition_[0][1] * dq0);
  rising_[1] = dq0 - (transition_[1][0] * q0 + transition_[1][1] * dq0);
  held_[0] = step_q - rising_[0];
  held_[1] = step_dq - rising_[1];
  force_ = force_at(q_, place_);
}

void RegenerativeCut::start(double q, double dq) {
  q_ = q;
  dq_ = dq;
  force_ = force_at(q_, place_);
}

// Force on the mode of all teeth where the cutter is displaced by q.
double RegenerativeCut::force_at(double q, int place) const {
  const CuttingCoefficients& K = cut_.coefficients;
  const int places = static_cast<int>(angles_.size());
  double f = 0.0;
  for (int tooth = 0; tooth < cut_.teeth; ++tooth) {
    const auto at = static_cast<std::size_t>((place + tooth * steps_) % places);
    const Angle& angle = angles_[at];
    if (angle.share <= 0.0) continue;
    double h = q * angle.along - surface_[at];
    double is_edge = 0.0;
    if (chips_ == Chips::real) {
      if (h <= 0.0) continue;
      is_edge = 1.0;
    }
    f -= angle.share * cut_.depth *
         ((K.Ktc * h + is_edge * K.Kte) * angle.tangential +
          (K.Krc * h + is_edge * K.Kre) * angle.along);
  }
  return f;
}

// The teeth leave their surface, which the next ones meet a feed per tooth later.
void RegenerativeCut::leave(int place) {
  const int places = static_cast<int>(angles_.size());
  for (int tooth = 0; tooth < cut_.teeth; ++tooth) {
    const auto at = static_cast<std::size_t>((place + tooth * steps_) % places);
    const Angle& angle = angles_[at];
    if (angle.share <= 0.0) continue;
    const double reach = q_ * angle.along;
    surface_[at] = chips_ == Chips::real ? std::max(surface_[at], reach) - angle.advance : reach;
  }
}

void RegenerativeCut::step() {
  leave(place_);
  const int next = (place_ + 1) % static_cast<int>(angles_.size());
  const double free_q = transition_[0][0] * q_ + transition_[0][1] * dq_ + held_[0] * force_;
  const double free_dq = transition_[1][0] * q_ + transition_[1][1] * dq_ + held_[1] * force_;
  double force = force_;
  for (int i = 0; i < kIterations; ++i) force = force_at(free_q + rising_[0] * force, next);
  q_ = free_q + rising_[0] * force;
  dq_ = free_dq + rising_[1] * force;
  force_ = force;
  place_ = next;
}

Eigen::VectorXd RegenerativeCut::state() const {
  Eigen::VectorXd x(2 + static_cast<Eigen::Index>(cutting_.size()));
  x[0] = q_;
  x[1] = dq_ / mode_.frequency;
  for (std::size_t i = 0; i < cutting_.size(); ++i) {
    x[2 + static_cast<Eigen::Index>(i)] = surface_[static_cast<std::size_t>(cutting_[i])];
  }
  return x;
}

void RegenerativeCut::scale(double factor) {
  q_ *= factor;
  dq_ *= factor;
  force_ *= factor;
  for (double& surface : surface_) surface *= factor;
}

double Multiplier::magnitude() const { return std::hypot(real, imaginary); }

// States x_n at the same angle of the teeth soon follow the largest multiplier, or a pair of them:
// x_{n+2} = p x_{n+1} + s x_n, fitted by least squares, has them as roots.
Multiplier chatter_multiplier(const SteadyCut& cut, const ChatterMode& mode, int steps) {
  RegenerativeCut run(cut, mode, RegenerativeCut::Chips::linear, steps);
  run.start(1.0, 0.3 * mode.frequency);
  const auto pass = [&] {
    for (int i = 0; i < steps; ++i) run.step();
  };
  for (int n = 0; n < kPassages; ++n) {
    pass();
    run.scale(1.0 / run.state().norm());
  }
  Eigen::Matrix2d normal = Eigen::Matrix2d::Zero();
  Eigen::Vector2d right = Eigen::Vector2d::Zero();
  for (int n = 0; n < kFitted; ++n) {
    run.scale(1.0 / run.state().norm());
    const Eigen::VectorXd x0 = run.state();
    pass();
    const Eigen::VectorXd x1 = run.state();
    RegenerativeCut ahead = run;
    for (int i = 0; i < steps; ++i) ahead.step();
    const Eigen::VectorXd x2 = ahead.state();
    normal(0, 0) += x1.dot(x1);
    normal(0, 1) += x1.dot(x0);
    normal(1, 0) += x1.dot(x0);
    normal(1, 1) += x0.dot(x0);
    right += Eigen::Vector2d(x1.dot(x2), x0.dot(x2));
  }
  const double det = normal.determinant();
  if (std::abs(det) < 1e-10 * normal(0, 0) * normal(1, 1)) {  // one real multiplier
    return {right[1] / normal(1, 1) / (normal(0, 1) / normal(1, 1)), 0.0};
  }
  const double p = (right[0] * normal(1, 1) - right[1] * normal(0, 1)) / det;
  const double s = (right[1] * normal(0, 0) - right[0] * normal(1, 0)) / det;
  const std::complex<double> root = std::sqrt(std::complex<double>(0.25 * p * p + s));
  const std::complex<double> first = 0.5 * p + root, second = 0.5 * p - root;
  const std::complex<double> largest = std::abs(first) >= std::abs(second) ? first : second;
  return {largest.real(), largest.imag()};
}

double stable_depth(SteadyCut cut, const ChatterMode& mode, double deepest, int steps) {
  const auto is_stable = [&](double depth) {
    cut.depth = depth;
    return chatter_multiplier(cut, mode, steps).magnitude() < 1.0;
  };
  double low = 0.0, high = 0.0;
  for (int n = 1; n <= kSearch && high == 0.0; ++n) {
    const double depth = deepest * n / kSearch;
    (is_stable(depth) ? low : high) = depth;
  }
  if (high == 0.0) return deepest;
  while (high - low > kDepthTol * high) {
    const double middle = 0.5 * (low + high);
    (is_stable(middle) ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace servomill::plant

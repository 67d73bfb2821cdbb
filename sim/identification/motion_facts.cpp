#include "sim/identification/motion_facts.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/numerics/decompositions.h"
#include "sim/numerics/dense_solver.h"

namespace servomill::sim::identification {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

std::vector<double> speed_of(const Record& r) {
  std::vector<double> v(r.size(), 0.0);
  for (std::size_t k = 1; k + 1 < r.size(); ++k) {
    v[k] = (r.command[k + 1] - r.command[k - 1]) / (2.0 * r.period);
  }
  return v;
}

double fastest(const std::vector<double>& v) {
  double out = 0.0;
  for (const double one : v) out = std::max(out, std::abs(one));
  return out;
}

std::vector<Ramp> ramps_of(const Record& r, const std::vector<double>& v) {
  constexpr double kConstant = 2e-3, kMoves = 1e-3;  // of the speed; of the fastest
  constexpr double kMinTime = 0.1;                   // s: the lag has settled in its last third
  std::vector<Ramp> out;
  const double least = kMoves * fastest(v);
  for (std::size_t begin = 1; begin + 1 < v.size();) {
    std::size_t end = begin;
    while (end + 1 < v.size() && std::abs(v[end] - v[begin]) <= kConstant * std::abs(v[begin])) {
      ++end;
    }
    const double time = r.period * static_cast<double>(end - begin);
    if (std::abs(v[begin]) > least && time >= kMinTime) {
      Ramp ramp{r.time(begin), r.time(end), 0.0, 0.0};
      const std::size_t last = begin + (end - begin) * 2 / 3;
      for (std::size_t k = last; k < end; ++k) {
        ramp.lag += (r.command[k] - r.feedback[k]) / static_cast<double>(end - last);
        ramp.speed += v[k] / static_cast<double>(end - last);
      }
      out.push_back(ramp);
    }
    begin = std::max(end, begin + 1);
  }
  return out;
}

std::optional<LagLaw> lag_law(const std::vector<Ramp>& ramps) {
  const auto n = static_cast<Eigen::Index>(ramps.size());
  if (n < 4) return std::nullopt;
  Eigen::MatrixXd X(n, 3);
  Eigen::VectorXd y(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Ramp& ramp = ramps[static_cast<std::size_t>(k)];
    X.row(k) << ramp.speed, ramp.speed > 0.0 ? 1.0 : -1.0, 1.0;
    y[k] = ramp.lag;
  }
  X.col(0) /= X.col(0).norm();
  const double unit = ramps[0].speed / X(0, 0);
  constexpr double kDependent = 1e-12;
  if (numerics::singular_values(numerics::triangular_factor(X)).rank(kDependent) < 3) {
    return std::nullopt;  // one speed, or one direction
  }
  const Eigen::Vector3d c = numerics::least_squares(X, y);
  const double variance = (y - X * c).squaredNorm() / static_cast<double>(n - 3);
  const Eigen::Matrix3d C = variance * numerics::inverse_of_definite(X.transpose() * X);
  return LagLaw{c[0] / unit, std::sqrt(C(0, 0)) / unit, c[1], std::sqrt(C(1, 1))};
}

// a cos + b sin + c of a signal at one frequency, and the rms that is left.
struct Harmonic {
  double a, b, rest;
  double size() const { return std::hypot(a, b); }
};
Harmonic harmonic_of(const std::vector<double>& signal, double w_T) {
  Eigen::MatrixXd X(static_cast<Eigen::Index>(signal.size()), 3);
  for (Eigen::Index k = 0; k < X.rows(); ++k) {
    const double angle = w_T * static_cast<double>(k);
    X.row(k) << std::cos(angle), std::sin(angle), 1.0;
  }
  const auto y = Eigen::VectorXd::Map(signal.data(), X.rows());
  const Eigen::Vector3d c = numerics::solve_symmetric(X.transpose() * X, X.transpose() * y);
  return {c[0], c[1], (y - X * c).norm() / std::sqrt(static_cast<double>(X.rows()))};
}

// Frequency by the crossings of the middle, refined until the rest is least.
std::optional<SineFacts> sine_of(const Record& r) {
  constexpr double kIsSine = 0.01;  // of the amplitude
  const auto [low, high] = std::minmax_element(r.command.begin(), r.command.end());
  const double middle = 0.5 * (*low + *high);
  std::vector<double> crossings;
  for (std::size_t k = 1; k < r.size(); ++k) {
    const double before = r.command[k - 1] - middle, after = r.command[k] - middle;
    if ((before < 0.0) == (after < 0.0)) continue;
    crossings.push_back(static_cast<double>(k - 1) + before / (before - after));
  }
  if (crossings.size() < 3) return std::nullopt;
  double w_T = 0.5 * kTurn * static_cast<double>(crossings.size() - 1) /
               (crossings.back() - crossings.front());
  double step = 0.02 * w_T;
  Harmonic best = harmonic_of(r.command, w_T);
  constexpr double kNearSine = 0.05;  // of the amplitude, before the frequency is refined
  if (!(best.rest < kNearSine * best.size())) return std::nullopt;
  for (int round = 0; round < 40; ++round, step *= 0.6) {
    for (const double other : {w_T - step, w_T + step}) {
      const Harmonic there = harmonic_of(r.command, other);
      if (there.rest >= best.rest) continue;
      best = there;
      w_T = other;
      break;
    }
  }
  if (!(best.rest < kIsSine * best.size())) return std::nullopt;
  const Harmonic out = harmonic_of(r.feedback, w_T);
  const double phase = std::remainder(std::atan2(out.b, out.a) - std::atan2(best.b, best.a), kTurn);
  const double w = w_T / r.period;
  return SineFacts{w / kTurn, best.size(), out.size() / best.size(), phase / w};
}

// Deviation of the lag from the law, greatest within a short time after the command turns.
std::vector<Reversal> reversals_of(const Record& r, const std::vector<double>& v, double lag_time) {
  constexpr double kTime = 0.05;  // s, before and after
  const auto reach = static_cast<std::size_t>(kTime / r.period);
  const double least = 1e-4 * fastest(v);
  std::vector<Reversal> out;
  double direction = 0.0;
  std::size_t last_moved = 0;
  for (std::size_t k = 0; k < v.size(); ++k) {
    if (std::abs(v[k]) <= least) continue;
    const double now = v[k] > 0.0 ? 1.0 : -1.0;
    if (direction * now < 0.0 && k > reach && k + reach < v.size() && k - last_moved < reach) {
      const auto beyond = [&](std::size_t n) {
        return r.command[n] - r.feedback[n] - lag_time * v[n];
      };
      double low = beyond(k), high = low;
      for (std::size_t n = k - reach; n <= k + reach; ++n) {
        low = std::min(low, beyond(n));
        high = std::max(high, beyond(n));
      }
      out.push_back({r.time(k), now > 0.0, high - low});
    }
    direction = now;
    last_moved = k;
  }
  return out;
}

}  // namespace

MotionFacts motion_facts(const Record& record) {
  MotionFacts out;
  const std::vector<double> v = speed_of(record);
  out.ramps = ramps_of(record, v);
  out.lag = lag_law(out.ramps);
  out.sine = sine_of(record);
  const double lag_time = out.lag ? out.lag->time : out.sine ? out.sine->lag_time : 0.0;
  if (out.lag || out.sine) out.reversals = reversals_of(record, v, lag_time);
  return out;
}

std::string motion_facts_text(const MotionFacts& facts, bool is_rotary) {
  const char* micro = is_rotary ? "urad" : "um";
  std::string out;
  if (facts.lag) {
    const LagLaw& lag = *facts.lag;
    out += fmt::format(
        "{} ramps: lag time {:.4g} +- {:.2g} ms (k = 2), as of Kv = {:.4g} 1/s without "
        "feed-forward; reversal +-{:.3g} +- {:.2g} {}\n",
        facts.ramps.size(), lag.time / ms, 2.0 * lag.time_deviation / ms, 1.0 / lag.time,
        lag.reversal / um, 2.0 * lag.reversal_deviation / um, micro);
  }
  if (facts.sine) {
    out += fmt::format(
        "circle or sine of {:.4g} Hz: amplitude {:.4g} {}, {:+.3g} {} in the "
        "feedback, lag time {:.4g} ms\n",
        facts.sine->frequency, facts.sine->amplitude / mm, is_rotary ? "mrad" : "mm",
        (facts.sine->gain - 1.0) * facts.sine->amplitude / um, micro, facts.sine->lag_time / ms);
  }
  if (facts.reversals.empty()) return out;
  const auto greatest =
      std::max_element(facts.reversals.begin(), facts.reversals.end(),
                       [](const Reversal& a, const Reversal& b) { return a.peak < b.peak; });
  return out +
         fmt::format("{} reversals: lag changes by up to {:.3g} {} within 0.05 s, at {:.4g} s\n",
                     facts.reversals.size(), greatest->peak / um, micro, greatest->time);
}

}  // namespace servomill::sim::identification

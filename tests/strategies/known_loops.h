/// Position loops with a closed form, as a strategy may know them.
#pragma once

#include <cmath>
#include <complex>
#include <memory>
#include <numbers>

#include "strategies/identified_loops.h"
#include "tests/strategies/identified_machines.h"

namespace servomill::strategies {

/// Kv over a velocity loop with PI control of one inertia, both in continuous time:
///
///     1/P = e^(s delay) + s/Kv e^(s delay) (J s^2 + Kp s + Ki) / (Kp s + Ki)
///     G/P = r^2 s / (Kv (Kp s + Ki)) e^(s delay)
struct KnownLoop {
  double Kv = 112.0, Kp = 3.1, Ki = 155.0, J = 15.7e-3, r = 20.0 * mm / (2.0 * std::numbers::pi);
  double delay = 90e-6;  // s

  std::complex<double> P(double w) const {
    const std::complex<double> s(0.0, w), pi = Kp * s + Ki;
    return std::exp(-s * delay) / (1.0 + s / Kv * (J * s * s + pi) / pi);
  }
  std::complex<double> force_over_P(double w) const {
    const std::complex<double> s(0.0, w);
    return r * r * s / (Kv * (Kp * s + Ki)) * std::exp(s * delay);
  }
};

inline LoopResponse response_of(const KnownLoop& loop) {
  LoopResponse out;
  for (double f = 0.1; f < 2500.0; f *= 1.08) {
    const double w = 2.0 * std::numbers::pi * f;
    out.f.push_back(f);
    out.displacement.push_back(-loop.P(w));
    out.current.emplace_back(0.0, w);
    out.force.push_back(loop.force_over_P(w) * loop.P(w));
  }
  return out;
}

/// All axes alike, without friction.
inline std::shared_ptr<IdentifiedLoops> known_loops(const KnownLoop& loop,
                                                    double period = kModelPeriod) {
  auto out = std::make_shared<IdentifiedLoops>();
  out->model_period = period;
  const auto response = std::make_shared<const LoopResponse>(response_of(loop));
  out->responses.fill(response);
  out->reading_noise.fill(5e-9);
  return out;
}

}  // namespace servomill::strategies

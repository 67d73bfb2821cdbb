#include "plant/sensing/encoder.h"

#include <cassert>
#include <numbers>

namespace servomill::plant {
namespace {

using std::numbers::pi;
using Complex = std::complex<double>;

constexpr double kMaxNoise = 0.2;  // rms; at 0.2 a signal of 5 sigma is lost

enum Channel : std::uint32_t { kSignals, kPosition };

// c + i s = turning exp(i theta) + counter_turning exp(-i theta) + offset
struct Signals {
  Complex turning, counter_turning, offset;
};

Signals signals_of(const EncoderParams& p) {
  const double half = p.quadrature_error / 2.0;
  return {{std::cos(half), -p.imbalance / 2.0 * std::sin(half)},
          {-p.imbalance / 2.0 * std::cos(half), -std::sin(half)},
          {p.cosine_offset, p.sine_offset}};
}

// Below 1 the pointer c + i s goes around the origin once a period and never the other way.
double disturbance(const EncoderParams& p) {
  const Signals signals = signals_of(p);
  return (std::abs(signals.counter_turning) + std::abs(signals.offset)) / std::abs(signals.turning);
}

double harmonics(const EncoderParams& p) {
  return std::abs(p.harmonic[0].amplitude) + std::abs(p.harmonic[1].amplitude);
}

bool has_signal_errors(const EncoderParams& p) {
  return p.sine_offset != 0.0 || p.cosine_offset != 0.0 || p.imbalance != 0.0 ||
         p.quadrature_error != 0.0 || harmonics(p) != 0.0;
}

// Without the tests for NaN and infinity of the library's product.
Complex product(Complex a, Complex b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

}  // namespace

EncoderParams from_periods_per_revolution(double periods, double subdivision) {
  EncoderParams params;
  params.period = 2.0 * pi / periods;
  params.step = subdivision > 0.0 ? params.period / subdivision : 0.0;
  return params;
}

std::vector<std::string> implausible(const EncoderParams& p) {
  std::vector<std::string> faults;
  const auto demand = [&](bool holds, const char* rule) {
    if (!holds) faults.emplace_back(rule);
  };
  demand(p.period >= 0.0, "period must be >= 0");
  demand(p.step >= 0.0, "step must be >= 0");
  demand(p.signal_noise >= 0.0 && p.signal_noise <= kMaxNoise, "signal_noise must be in [0, 0.2]");
  demand(p.position_noise >= 0.0, "position_noise must be >= 0");
  demand(p.frequency_limit > 0.0, "frequency_limit must be > 0");
  if (p.period > 0.0) {
    demand(p.step <= p.period, "step must be <= period");
    demand(disturbance(p) < 1.0,
           "offsets, imbalance and quadrature_error must leave a non-zero signal over the whole "
           "period");
    demand(harmonics(p) < p.period / 4.0, "harmonic must add up to less than period / 4");
  } else {
    const bool needs_signals =
        has_signal_errors(p) || p.signal_noise > 0.0 || std::isfinite(p.frequency_limit);
    demand(!needs_signals, "period must be > 0 for errors, noise and frequency of the signals");
  }
  return faults;
}

Encoder::Encoder(const EncoderParams& params, const NoiseKey& key)
    : step_(params.step),
      per_step_(params.step > 0.0 ? 1.0 / params.step : 0.0),
      disturbed_(has_signal_errors(params)),
      noisy_(params.signal_noise > 0.0 || params.position_noise > 0.0),
      periods_per_unit_(params.period > 0.0 ? 1.0 / params.period : 0.0),
      period_per_radian_(params.period / (2.0 * pi)),
      signal_noise_(params.signal_noise),
      position_noise_(params.position_noise),
      frequency_limit_(params.frequency_limit),
      key_(key),
      params_(params) {
  assert(implausible(params).empty());
  const Signals signals = signals_of(params);
  ellipse_ = signals.counter_turning / signals.turning;
  centre_ = signals.offset / signals.turning;
  for (std::size_t k = 0; k < 2; ++k) {
    harmonic_[k] = std::polar(1.0, params.harmonic[k].phase) * params.harmonic[k].amplitude;
  }
}

Encoder Encoder::with_step(double measuring_step) {
  EncoderParams params;
  params.step = measuring_step;
  return Encoder(params);
}

Encoder Encoder::in_run(std::uint64_t run) const {
  constexpr std::uint64_t kFarApart = 0x9e3779b97f4a7c15;  // 2^64 by the golden ratio
  Encoder out = *this;
  out.key_.seed += run * kFarApart;
  return out;
}

// With the turning part divided out, the pointer is 1 + ellipse exp(-2 i theta) + centre
// exp(-i theta): its angle is the error itself, and no counter is needed to add whole periods.
double Encoder::interpolation_error(double position, Complex noise) const {
  const double periods = position * periods_per_unit_;
  const double theta = 2.0 * pi * (periods - std::nearbyint(periods));
  const Complex back(std::cos(theta), -std::sin(theta));
  const Complex pointer = 1.0 + product(product(ellipse_, back) + centre_, back) + noise;
  const Complex forth = std::conj(back);
  const Complex sum = product(product(harmonic_[1], forth) + harmonic_[0], forth);
  return period_per_radian_ * std::arg(pointer) + sum.imag();
}

double Encoder::period_error(double position) const {
  return disturbed_ ? interpolation_error(position, 0.0) : 0.0;
}

double Encoder::with_noise(double position, Tick now) const {
  double reading = position;
  if (signal_noise_ > 0.0) {
    const auto noise = white_noise(key_, kSignals, now);
    reading += interpolation_error(position, signal_noise_ * Complex(noise[0], noise[1]));
  } else {
    reading += period_error(position);
  }
  if (position_noise_ > 0.0) reading += position_noise_ * white_noise(key_, kPosition, now)[0];
  return reading;
}

}  // namespace servomill::plant

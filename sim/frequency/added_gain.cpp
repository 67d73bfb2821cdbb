#include "sim/frequency/added_gain.h"

#include <cmath>
#include <numbers>

#include "sim/frequency/axis_dynamics.h"
#include "sim/frequency/frequency_response.h"
#include "sim/frequency/stability.h"

namespace servomill::sim::frequency {
namespace {

constexpr double kFirstStep = 0.02, kTol = 1e-4;  // of Kv, between gains that are tried
constexpr double kMaxGain = 20.0;                 // of Kv

bool leaves(const Margins& margins, const WantedMargins& wanted) {
  return margins.gain >= wanted.gain && margins.phase >= wanted.phase;
}

}  // namespace

std::vector<double> position_grid(const model::MachineSettings& machine, int joint,
                                  Tick reading_delay) {
  const double nyquist = 0.5 / machine.nc.periods.seconds(machine.nc.periods.position);
  return logarithmic(
      kLowestFrequency, nyquist, kFrequencies,
      ringing_frequencies(machine, joint, reading_delay, PositionLoop::closed, nyquist));
}

ResponseAt open_position(FrequencyResponse& response) {
  return [&](double f) {
    return ratio(response.at(Entry::setpoint, f), AxisSignal::reading, AxisSignal::position_error);
  };
}

Curve open_position_loop(const model::MachineSettings& machine, int joint, Tick reading_delay) {
  const model::MachineSettings linear = linearised(machine);
  FrequencyResponse response(linear, joint, reading_delay, PositionLoop::closed);
  return curve_of(open_position(response), position_grid(linear, joint, reading_delay));
}

Margins margins_with(const Curve& open_loop, double Kv, const AddedGain& added) {
  Curve with = open_loop;
  for (std::size_t n = 0; n < with.f.size(); ++n) {
    std::complex<double> gain = Kv + added.C;
    if (added.Ti > 0.0) {
      gain += added.C / (added.Ti * std::complex<double>(0.0, 2.0 * std::numbers::pi * with.f[n]));
    }
    with.y[n] *= gain / Kv;
  }
  return margins_of(with);
}

double largest_added_gain(const Curve& open_loop, double Kv, double largest_Kv,
                          const WantedMargins& wanted) {
  const auto is_good = [&](double C) {
    const double Ti = wanted.Ti > 0.0 ? wanted.Ti : wanted.reset_ratio / (largest_Kv + C);
    return leaves(margins_with(open_loop, Kv, {C, Ti}), wanted);
  };
  double good = 0.0, bad = 0.0;
  if (!is_good(0.0)) return 0.0;
  while (bad < kMaxGain * Kv) {
    bad = good + kFirstStep * Kv;
    if (!is_good(bad)) break;
    good = bad;
  }
  while (bad - good > kTol * Kv) {
    const double middle = 0.5 * (good + bad);
    (is_good(middle) ? good : bad) = middle;
  }
  return good;
}

}  // namespace servomill::sim::frequency

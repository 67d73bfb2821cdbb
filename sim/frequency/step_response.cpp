#include "sim/frequency/step_response.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "sim/frequency/axis_test_bench.h"

namespace servomill::sim::frequency {
namespace {

constexpr double kNever = std::numeric_limits<double>::quiet_NaN();

// First time at which y reaches `level` of the same sign.
double time_of(const std::vector<double>& time, const std::vector<double>& y, double level) {
  for (std::size_t n = 1; n < y.size(); ++n) {
    if (std::abs(y[n]) < std::abs(level) || y[n] * level < 0.0) continue;
    const double t = (level - y[n - 1]) / (y[n] - y[n - 1]);
    return time[n - 1] + t * (time[n] - time[n - 1]);
  }
  return kNever;
}

double settled_after(const std::vector<double>& time, const std::vector<double>& y, double target,
                     double band) {
  std::size_t n = y.size();
  while (n > 0 && std::abs(y[n - 1] - target) <= band) --n;
  return n == y.size() ? kNever : time[n];
}

StandInput input_of(const StepSettings& s) {
  StandInput in;
  in.q = s.position;
  switch (s.kind) {
    case StepKind::position:
      in.q += s.amplitude;
      break;
    case StepKind::velocity:
      in.added.velocity = s.amplitude;
      break;
    case StepKind::load:
      in.added.force = s.amplitude;
      break;
  }
  return in;
}

}  // namespace

StepFigures figures_of(StepKind kind, const std::vector<double>& time, const std::vector<double>& y,
                       double amplitude, double band) {
  assert(!y.empty() && time.size() == y.size());
  StepFigures out;
  const auto farthest = std::max_element(
      y.begin(), y.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  if (kind == StepKind::load) {
    out.peak = *farthest;
    out.peak_time = time[static_cast<std::size_t>(farthest - y.begin())];
    out.rise_time = kNever;
    out.steady_error = y.back();
    out.settling_time = settled_after(time, y, 0.0, band * std::abs(out.peak));
    return out;
  }
  const auto highest = std::max_element(
      y.begin(), y.end(), [&](double a, double b) { return a / amplitude < b / amplitude; });
  out.peak = *highest;
  out.peak_time = time[static_cast<std::size_t>(highest - y.begin())];
  out.overshoot = std::max(0.0, out.peak / amplitude - 1.0);
  out.rise_time = time_of(time, y, 0.9 * amplitude) - time_of(time, y, 0.1 * amplitude);
  out.settling_time = settled_after(time, y, amplitude, band * std::abs(amplitude));
  out.steady_error = amplitude - y.back();
  return out;
}

StepResponse step_response(const model::MachineSettings& machine, int joint, Tick reading_delay,
                           const StepSettings& settings, Tick every) {
  assert(settings.amplitude != 0.0 && settings.duration > 0.0 && every > 0);
  const PositionLoop loop =
      settings.kind == StepKind::velocity ? PositionLoop::open : PositionLoop::closed;
  AxisTestBench stand(machine, joint, reading_delay, loop);
  stand.settle(settings.position);
  const StandInput in = input_of(settings);
  StepResponse out;
  const auto record = [&](Tick n, std::uint8_t, AxisSignals y) {
    out.peak_current = std::max(out.peak_current, std::abs(y[index_of(AxisSignal::current)]));
    if (n % every != 0) return;
    y[index_of(AxisSignal::position)] -= settings.position;
    y[index_of(AxisSignal::reading)] -= settings.position;
    out.time.push_back(machine.nc.periods.seconds(n));
    out.signals.push_back(y);
  };
  const Tick periods = static_cast<Tick>(std::ceil(settings.duration / stand.period()));
  Stage stage("", static_cast<double>(periods + 1));
  for (Tick p = 0; p <= periods; ++p) {
    throw_if_interrupted();
    stage.advance();
    stand.run(
        p * stand.hyperperiod(), [&](Tick) { return in; }, record);
  }
  out.fault = stand.fault();

  const double r = machine.drives[static_cast<std::size_t>(joint)].r;
  std::vector<double> y;
  y.reserve(out.signals.size());
  for (const AxisSignals& row : out.signals) {
    y.push_back(settings.kind == StepKind::velocity ? r * row[index_of(AxisSignal::motor_speed)]
                                                    : row[index_of(AxisSignal::position)]);
  }
  out.figures = figures_of(settings.kind, out.time, y, settings.amplitude, settings.band);
  return out;
}

}  // namespace servomill::sim::frequency

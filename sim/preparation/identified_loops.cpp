#include "sim/preparation/identified_loops.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "plant/vocabulary/interrupt.h"
#include "sim/frequency/axis_dynamics.h"
#include "sim/frequency/frequency_response.h"
#include "sim/frequency/margins.h"
#include "sim/frequency/stability.h"
#include "sim/preparation/preparation_cache.h"

namespace servomill::sim::preparation {
namespace {

using Complex = std::complex<double>;
using frequency::AxisSignal;

constexpr double kFirstFrequency = 0.1;  // Hz; below, an axis follows
constexpr std::size_t kSpaced = 120;     // before those where it rings

// From a displacement that is found at a model instant to its mean while it is held: one period
// until it acts, half a one on the average that it stands.
Complex found_to_acting(double w, double period) {
  const double half = 0.5 * w * period;
  return std::polar(std::sin(half) / half, -3.0 * half);
}

strategies::LoopResponse loop_response(const model::MachineSettings& machine, int joint,
                                       Tick reading_delay, double model_period) {
  const model::LoopPeriods& periods = machine.nc.periods;
  const double nyquist = 0.499 / periods.seconds(periods.position);
  strategies::LoopResponse out;
  out.f = frequency::logarithmic(
      kFirstFrequency, nyquist, kSpaced,
      frequency::ringing_frequencies(machine, joint, reading_delay, frequency::PositionLoop::closed,
                                     nyquist));
  frequency::FrequencyResponse response(machine, joint, reading_delay,
                                        frequency::PositionLoop::closed);
  for (const double f : out.f) {
    throw_if_interrupted();
    const Complex acting = found_to_acting(2.0 * std::numbers::pi * f, model_period);
    const frequency::Response read = response.at(frequency::Entry::reading, f);
    out.displacement.push_back(acting * read[frequency::index_of(AxisSignal::position)]);
    out.current.push_back(acting * read[frequency::index_of(AxisSignal::current)]);
    out.force.push_back(
        response.at(frequency::Entry::force, f)[frequency::index_of(AxisSignal::position)]);
  }
  return out;
}

// Standard deviation of one reading, without the error that repeats with the signal: steps and
// noise, of readings that are spread over some millimetres.
double reading_noise(const plant::Encoder& scale) {
  constexpr int kReadings = 2000;
  constexpr double kApart = 1e-6 * std::numbers::sqrt2;  // m, rad: no multiple of a step
  double sum = 0.0;
  for (int n = 0; n < kReadings; ++n) {
    const double x = n * kApart;
    const double error = scale.read(x, n) - x - scale.period_error(x);
    sum += error * error;
  }
  return std::sqrt(sum / kReadings);
}

strategies::BristleFriction bristles_of(const plant::FrictionParams& p) {
  if (p.kind == plant::FrictionKind::none) return {};
  const bool has_bristles = p.kind == plant::FrictionKind::lugre;
  return {p.Fc_positive,
          p.Fc_negative,
          p.Fs_positive,
          p.Fs_negative,
          p.b_positive,
          p.b_negative,
          p.vs,
          has_bristles ? p.sigma0 : std::max(p.Fs_positive, p.Fs_negative) / kPresliding,
          has_bristles ? p.sigma1 : 0.0};
}

void add(system::MemoKey& key, const strategies::BristleFriction& friction) {
  const auto& [Fc_positive, Fc_negative, Fs_positive, Fs_negative, b_positive, b_negative, vs,
               sigma0, sigma1] = friction;
  for (const double value : {Fc_positive, Fc_negative, Fs_positive, Fs_negative, b_positive,
                             b_negative, vs, sigma0, sigma1}) {
    key.add(value);
  }
}

}  // namespace

std::shared_ptr<const strategies::IdentifiedLoops> identified_loops(
    const model::MachineSettings& machine, Tick reading_delay, double model_period,
    PreparationCache& cache) {
  auto out = std::make_shared<strategies::IdentifiedLoops>();
  out->model_period = model_period;
  const model::MachineSettings linear = frequency::linearised(machine);
  for (const int joint : machine.joints()) {
    const auto j = static_cast<std::size_t>(joint);
    system::MemoKey key;
    key.add(reading_delay);
    key.add(model_period);
    add_linear_axis(key, linear, joint);
    out->responses[j] = cache.loop_responses.get(
        key, [&] { return loop_response(linear, joint, reading_delay, model_period); });
    out->friction[j] = bristles_of(machine.drives[j].friction);
    out->reading_noise[j] = reading_noise(machine.scale[j]);
  }
  return out;
}

void add(system::MemoKey& key, const strategies::IdentifiedLoops& loops) {
  const auto& [model_period, responses, friction, reading_noise] = loops;
  key.add(model_period);
  for (const auto& response : responses) key.add_shared(response.get());
  for (const strategies::BristleFriction& one : friction) add(key, one);
  for (const double noise : reading_noise) key.add(noise);
}

}  // namespace servomill::sim::preparation

#include "sim/frequency/bode.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "sim/model/scenario.h"

namespace servomill::sim {
namespace {

constexpr std::size_t kDrawn = 600;    // points of an exact curve
constexpr double kLowest = 0.1;        // Hz; margins are sought from here to the Nyquist frequency
constexpr double kDefaultReach = 0.8;  // of the Nyquist frequency

// A curve as output over what is fed in, or over another signal.
struct CurveOf {
  const char* name;
  const char* long_name;
  Entry entry;
  AxisSignal output;
  std::optional<AxisSignal> input;
  bool in_slide_units = false;  // motor speed as slide velocity
};

constexpr CurveOf kPosition[] = {
    {"position_open", "open position loop", Entry::set_point, AxisSignal::reading,
     AxisSignal::position_error},
    {"position_closed", "closed position loop, without feed-forward", Entry::set_point,
     AxisSignal::position, std::nullopt},
    {"position_fed_forward", "closed position loop, with feed-forward",
     Entry::set_point_fed_forward, AxisSignal::position, std::nullopt},
};
constexpr CurveOf kVelocity[] = {
    {"velocity_open", "open velocity loop", Entry::velocity_command, AxisSignal::measured_speed,
     AxisSignal::speed_error},
    {"velocity_closed", "closed velocity loop", Entry::velocity_command, AxisSignal::motor_speed,
     std::nullopt, true},
};
constexpr CurveOf kCompliance[] = {
    {"compliance", "compliance of the slide", Entry::force, AxisSignal::position, std::nullopt},
};

std::span<const CurveOf> curves_of(BodeLoop loop) {
  switch (loop) {
    case BodeLoop::position:
      return kPosition;
    case BodeLoop::velocity:
      return kVelocity;
    case BodeLoop::compliance:
      break;
  }
  return kCompliance;
}

Complex taken(const CurveOf& of, const Response& response, double r) {
  if (of.input) return ratio(response, of.output, *of.input);
  return response[index_of(of.output)] * (of.in_slide_units ? r : 1.0);
}

// Acceleration whose feed-forward takes a share of the current.
double fed_forward_acceleration(const MachineSettings& machine, int joint) {
  constexpr double kShare = 0.3;
  const controllers::CascadeParams& c = machine.nc.cascade[static_cast<std::size_t>(joint)];
  return kShare * c.i_max * c.Kt * c.r / (c.kaf * c.J);  // infinite without feed-forward
}

}  // namespace

double nyquist_frequency(const LoopPeriods& periods, BodeLoop loop) {
  return 0.5 / periods.seconds(loop == BodeLoop::velocity ? periods.velocity : periods.position);
}

BodeResult bode(const MachineSettings& machine, int joint, Tick reading_delay,
                const BodeSettings& settings) {
  const PositionLoop loop =
      settings.loop == BodeLoop::velocity ? PositionLoop::open : PositionLoop::closed;
  const double r = machine.drives[static_cast<std::size_t>(joint)].r;
  BodeResult out;
  out.loop = settings.loop;
  out.nyquist = nyquist_frequency(machine.nc.periods, settings.loop);
  out.time_constant = slowest_time_constant(machine, joint, reading_delay, loop);
  out.stable = std::isfinite(out.time_constant);
  out.has_stable_velocity_loop = out.stable || velocity_spectral_radius(machine, joint) < 1.0;
  out.measured = settings.measure && out.stable;
  out.method = settings.method;

  FrequencyResponse exact(machine, joint, reading_delay, loop);
  const double reach = kDefaultReach * out.nyquist;
  const double to = settings.to.value_or(settings.from < reach ? reach : out.nyquist);
  const std::vector<double> wanted = logarithmic(settings.from, to, settings.points);
  const std::vector<double> rings =
      ringing_frequencies(machine, joint, reading_delay, loop, out.nyquist);
  Measurement how;
  how.method = settings.method;
  std::vector<MeasuredPoint> points;
  for (const CurveOf& of : curves_of(settings.loop)) {
    const ResponseAt at = [&](double f) { return taken(of, exact.at(of.entry, f), r); };
    if (out.measured && (points.empty() || of.entry != how.entry)) {
      how.entry = of.entry;
      how.amplitude = settings.amplitude.value_or(default_amplitude(machine, joint, of.entry));
      how.velocity =
          settings.velocity.value_or(default_velocity(machine, joint, of.entry, how.amplitude));
      if (of.entry == Entry::set_point_fed_forward) {
        how.max_acceleration = fed_forward_acceleration(machine, joint);
      }
      const MeasuredResponse measured = measure(machine, joint, reading_delay, loop, how, wanted);
      if (measured.fault) {
        out.fault = measured.fault;
        out.measured = false;
        points.clear();
      } else {
        points = measured.points;
      }
      out.current_limited = out.current_limited || measured.current_limited;
      out.amplitude = how.amplitude;
      out.velocity = how.velocity;
      out.crest_factor = measured.crest_factor;
      out.peak_current = std::max(out.peak_current, measured.peak_current);
      out.simulated_time += measured.simulated_time;
    }
    BodeCurve& curve = out.curves.emplace_back();
    curve.name = of.name;
    curve.long_name = of.long_name;
    curve.exact = curve_of(at, logarithmic(settings.from, to, kDrawn, rings));
    if (!out.measured) curve.f = wanted;
    for (const MeasuredPoint& point : points) {
      curve.f.push_back(point.f);
      constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
      const bool known = !of.input || resolved(point, of.output, *of.input);
      curve.measured.push_back(known ? taken(of, point.response, r) : Complex(kUnknown, kUnknown));
    }
    for (const double f : curve.f) curve.exact_at.push_back(at(f));

    // what is read off, over the whole range
    const auto whole = [&] {
      return curve_of(at, logarithmic(kLowest, out.nyquist, kDrawn, rings));
    };
    if (curve.name == "position_open" || curve.name == "velocity_open") {
      out.margins = margins_of(whole(), at);
    } else if (curve.name == "position_closed" || curve.name == "velocity_closed") {
      out.closed = closed_loop_of(whole(), at);
    } else if (curve.name == "compliance") {
      out.closed.peak = 0.0;
      const Curve all = whole();
      for (std::size_t i = 0; i < all.f.size(); ++i) {
        if (std::abs(all.y[i]) <= out.closed.peak) continue;
        out.closed.peak = std::abs(all.y[i]);
        out.closed.peak_frequency = all.f[i];
      }
    }
  }
  if (out.fault) {
    for (BodeCurve& curve : out.curves) curve.measured.clear();
  }
  return out;
}

Tick reading_delay_of(const Scenario& scenario) {
  const bool hardware = std::any_of(scenario.cases.begin(), scenario.cases.end(),
                                    [](const CaseSpec& one) { return one.feedback_hardware; });
  return scenario.machine.scale_delay + (hardware ? scenario.hardware.signal_delay : 0);
}

}  // namespace servomill::sim

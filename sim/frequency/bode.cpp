#include "sim/frequency/bode.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include "plant/vocabulary/progress.h"
#include "sim/frequency/axis_dynamics.h"
#include "sim/frequency/frequency_response.h"
#include "sim/frequency/measured_response.h"
#include "sim/model/scenario.h"

namespace servomill::sim::frequency {
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
    {"position_open", "open position loop", Entry::setpoint, AxisSignal::reading,
     AxisSignal::position_error},
    {"position_closed", "closed position loop, without feed-forward", Entry::setpoint,
     AxisSignal::position, std::nullopt},
    {"position_fed_forward", "closed position loop, with feed-forward", Entry::setpoint_fed_forward,
     AxisSignal::position, std::nullopt},
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

// Neighbours with the same entry share one.
double measurements_of(std::span<const CurveOf> curves) {
  double out = 1.0;
  for (std::size_t k = 1; k < curves.size(); ++k) {
    if (curves[k].entry != curves[k - 1].entry) out += 1.0;
  }
  return out;
}

Complex taken(const CurveOf& of, const Response& response, double r) {
  if (of.input) return ratio(response, of.output, *of.input);
  return response[index_of(of.output)] * (of.in_slide_units ? r : 1.0);
}

// Acceleration whose feed-forward takes a share of the current.
double fed_forward_acceleration(const model::MachineSettings& machine, int joint) {
  // Leaves 70 % of the current for friction and the loop, so that the excitation meets no limit.
  constexpr double kShare = 0.3;
  const controllers::CascadeParams& c = machine.nc.cascade[static_cast<std::size_t>(joint)];
  return kShare * c.i_max * c.Kt * c.r / (c.kaf * c.J);  // infinite without feed-forward
}

// The peak of a response over frequency.
ClosedLoop peak_of(const Curve& curve) {
  ClosedLoop out;
  out.peak = 0.0;
  for (std::size_t i = 0; i < curve.f.size(); ++i) {
    if (std::abs(curve.y[i]) <= out.peak) continue;
    out.peak = std::abs(curve.y[i]);
    out.peak_frequency = curve.f[i];
  }
  return out;
}

// All curves of one loop; those with the same entry share a measurement.
class LoopCurves {
 public:
  LoopCurves(const model::MachineSettings& machine, int joint, Tick reading_delay,
             const BodeSettings& settings)
      : machine_(machine),
        joint_(joint),
        reading_delay_(reading_delay),
        settings_(settings),
        loop_(settings.loop == BodeLoop::velocity ? PositionLoop::open : PositionLoop::closed),
        r_(machine.drives[static_cast<std::size_t>(joint)].r),
        exact_(machine, joint, reading_delay, loop_) {
    out_.loop = settings.loop;
    out_.nyquist = nyquist_frequency(machine.nc.periods, settings.loop);
    out_.time_constant = slowest_time_constant(machine, joint, reading_delay, loop_);
    out_.stable = std::isfinite(out_.time_constant);
    out_.has_stable_velocity_loop = out_.stable || velocity_spectral_radius(machine, joint) < 1.0;
    out_.measured = settings.measure && out_.stable;
    out_.method = settings.method;
    how_.method = settings.method;
    const double reach = kDefaultReach * out_.nyquist;
    to_ = settings.to.value_or(settings.from < reach ? reach : out_.nyquist);
    wanted_ = logarithmic(settings.from, to_, settings.points);
    rings_ = ringing_frequencies(machine, joint, reading_delay, loop_, out_.nyquist);
  }

  void add(const CurveOf& of) {
    if (out_.measured && (points_.empty() || of.entry != how_.entry)) measure_from(of.entry);
    const ResponseAt at = [&](double f) { return taken(of, exact_.at(of.entry, f), r_); };
    BodeCurve& curve = out_.curves.emplace_back();
    curve.name = of.name;
    curve.long_name = of.long_name;
    curve.exact = curve_of(at, logarithmic(settings_.from, to_, kDrawn, rings_));
    if (!out_.measured) curve.f = wanted_;
    for (const MeasuredPoint& point : points_) {
      curve.f.push_back(point.f);
      constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
      const bool known = !of.input || resolved(point, of.output, *of.input);
      curve.measured.push_back(known ? taken(of, point.response, r_) : Complex(kUnknown, kUnknown));
    }
    for (const double f : curve.f) curve.exact_at.push_back(at(f));
    read_off(curve.name, at);
  }

  BodeResult result() && {
    if (out_.fault) {
      for (BodeCurve& curve : out_.curves) curve.measured.clear();
    }
    return std::move(out_);
  }

 private:
  void measure_from(Entry entry) {
    how_.entry = entry;
    how_.amplitude = settings_.amplitude.value_or(default_amplitude(machine_, joint_, entry));
    how_.velocity =
        settings_.velocity.value_or(default_velocity(machine_, joint_, entry, how_.amplitude));
    if (entry == Entry::setpoint_fed_forward) {
      how_.max_acceleration = fed_forward_acceleration(machine_, joint_);
    }
    const MeasuredResponse measured =
        measure(machine_, joint_, reading_delay_, loop_, how_, wanted_);
    if (measured.fault) {
      out_.fault = measured.fault;
      out_.measured = false;
      points_.clear();
    } else {
      points_ = measured.points;
    }
    out_.current_limited = out_.current_limited || measured.current_limited;
    out_.amplitude = how_.amplitude;
    out_.velocity = how_.velocity;
    out_.crest_factor = measured.crest_factor;
    out_.peak_current = std::max(out_.peak_current, measured.peak_current);
    out_.simulated_time += measured.simulated_time;
  }

  // Over the whole range, whatever part of it is shown.
  void read_off(std::string_view name, const ResponseAt& at) {
    const auto whole = [&] {
      return curve_of(at, logarithmic(kLowest, out_.nyquist, kDrawn, rings_));
    };
    if (name == "position_open" || name == "velocity_open") {
      out_.margins = margins_of(whole(), at);
    } else if (name == "position_closed" || name == "velocity_closed") {
      out_.closed = closed_loop_of(whole(), at);
    } else if (name == "compliance") {
      out_.closed = peak_of(whole());
    }
  }

  const model::MachineSettings& machine_;
  int joint_;
  Tick reading_delay_;
  const BodeSettings& settings_;
  PositionLoop loop_;
  double r_;  // m or rad of the slide per rad of the motor
  FrequencyResponse exact_;
  double to_ = 0.0;             // Hz
  std::vector<double> wanted_;  // Hz
  std::vector<double> rings_;   // Hz
  Measurement how_;
  std::vector<MeasuredPoint> points_;
  BodeResult out_;
};

}  // namespace

double nyquist_frequency(const model::LoopPeriods& periods, BodeLoop loop) {
  return 0.5 / periods.seconds(loop == BodeLoop::velocity ? periods.velocity : periods.position);
}

BodeResult bode(const model::MachineSettings& machine, int joint, Tick reading_delay,
                const BodeSettings& settings) {
  LoopCurves curves(machine, joint, reading_delay, settings);
  const std::span<const CurveOf> all = curves_of(settings.loop);
  Stage stage("measurements", measurements_of(all));
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (k > 0 && all[k].entry != all[k - 1].entry) stage.advance();
    curves.add(all[k]);
  }
  return std::move(curves).result();
}

Tick reading_delay_of(const model::Scenario& scenario) {
  Tick longest = scenario.machine.scale_delay;
  for (const model::CaseSpec& one : scenario.cases) {
    longest = std::max(longest, scenario.reading_delay_of(one));
  }
  return longest;
}

}  // namespace servomill::sim::frequency

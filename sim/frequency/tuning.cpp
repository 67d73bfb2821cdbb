#include "sim/frequency/tuning.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <numbers>

#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/units.h"
#include "sim/frequency/added_gain.h"
#include "sim/frequency/axis_dynamics.h"
#include "sim/frequency/frequency_response.h"
#include "sim/frequency/stability.h"
#include "sim/frequency/step_response.h"

namespace servomill::sim::frequency {
namespace {

constexpr double kScan = 1.15;          // factor between gains that are tried
constexpr double kGainTol = 1e-4;       // of a gain that is sought
constexpr double kMinBandwidth = 20.0;  // rad/s; below, friction holds the motor, not its inertia
constexpr double kCalmer[] = {0.8, 0.65, 0.5};  // of the largest velocity bandwidth
constexpr double kWorthIt = 1.05;               // gain in Kv
constexpr double kMinKv = 1.0;                  // 1/s
constexpr double kStepHeight = 1e-4;            // m, rad; the model is linear
constexpr double kStepDuration = 12.0;          // of the slowest time constant
constexpr double kLongestStep = 5.0;            // s

ResponseAt open_velocity(FrequencyResponse& response) {
  return [&](double f) {
    return ratio(response.at(Entry::velocity_command, f), AxisSignal::measured_speed,
                 AxisSignal::speed_error);
  };
}
std::vector<double> velocity_grid(const model::MachineSettings& machine, int joint) {
  const double nyquist = 0.5 / machine.nc.periods.seconds(machine.nc.periods.velocity);
  return logarithmic(kLowestFrequency, nyquist, kFrequencies,
                     ringing_frequencies(machine, joint, 0, PositionLoop::open, nyquist));
}

// Which margin is missed, if any.
std::optional<Limit> missed(const Margins& m, const TuneSettings& wanted) {
  if (m.gain < wanted.gain_margin) return Limit{Limit::Kind::gain_margin, m.gain_frequency};
  if (m.phase < wanted.phase_margin) return Limit{Limit::Kind::phase_margin, m.crossover};
  return std::nullopt;
}

struct Largest {
  double gain = 0.0;
  Limit limit;
};

// The end of the first stretch of gains for which nothing is missed; 0 if there is none.
Largest largest_gain(double least, double most,
                     const std::function<std::optional<Limit>(double)>& check) {
  Largest found;
  double previous = 0.0;
  Stage tried("gains tried", 0.0, Steps::unlike);
  // A scan before the bisection: margins need not fall steadily with the gain, and beyond a
  // resonance they may come back.
  for (double gain = least; gain <= most; gain *= kScan) {
    throw_if_interrupted();
    const auto limit = check(gain);
    tried.advance();
    if (!limit) {
      previous = gain;
    } else if (previous > 0.0) {
      found.limit = *limit;
      double good = previous, bad = gain;
      while (bad - good > kGainTol * good) {
        const double middle = 0.5 * (good + bad);
        tried.advance();
        if (const auto why = check(middle)) {
          bad = middle;
          found.limit = *why;
        } else {
          good = middle;
        }
      }
      found.gain = good;
      return found;
    }
  }
  found.gain = previous;
  return found;
}

// Four digits, as they are printed and typed into the control; downwards, so that the margins stay.
double rounded_down(double value) {
  if (value <= 0.0) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 3.0);
  return std::floor(value / unit) * unit;
}
double rounded_up(double value) {
  const double unit = std::pow(10.0, std::floor(std::log10(value)) - 3.0);
  return std::ceil(value / unit) * unit;
}

// The gain, rounded down and lowered further as far as needed for what it leads to being kept; 0 if
// half of it is not enough.
template <class Kept>
double kept_at(double gain, const Kept& kept) {
  // Doubled each time: nine trials, since each evaluates the whole loop.
  constexpr double kFirst = 1e-3, kMax = 0.5;
  double tried = rounded_down(gain);
  for (double share = kFirst; share <= kMax; share *= 2.0) {
    throw_if_interrupted();
    if (kept(tried)) return tried;
    tried = rounded_down((1.0 - share) * gain);
  }
  return 0.0;
}

Margins velocity_margins(const model::MachineSettings& machine, int joint) {
  FrequencyResponse response(machine, joint, 0, PositionLoop::open);
  const ResponseAt L = open_velocity(response);
  return margins_of(curve_of(L, velocity_grid(machine, joint)), L);
}

double step_overshoot(const model::MachineSettings& linear, int joint, Tick reading_delay) {
  const double slowest = slowest_time_constant(linear, joint, reading_delay, PositionLoop::closed);
  if (!std::isfinite(slowest)) return Margins::kNone;
  StepSettings step;
  step.amplitude = kStepHeight;
  // Long enough for the overshoot of the slowest mode to have passed.
  step.duration = std::min(kLongestStep, kStepDuration * slowest);
  return step_response(linear, joint, reading_delay, step).figures.overshoot;
}

[[noreturn]] void no_gain(const model::MachineSettings& machine, int joint, std::string_view gain,
                          const TuneSettings& wanted) {
  throw InputError(
      {"axis " + std::string(1, machine.chain.layout.letter_of(joint))},
      fmt::format("no {} gives both a phase margin of {:.4g} deg and a gain margin of {:.4g} dB; "
                  "lower the margins or raise --reset-ratio",
                  gain, wanted.phase_margin / deg, 20.0 * std::log10(wanted.gain_margin)));
}

Largest largest_Kv(const model::MachineSettings& machine, int joint, Tick reading_delay,
                   Gains gains, const TuneSettings& wanted) {
  // The open position loop is in proportion to Kv: one curve serves all gains.
  gains.Kv = 1.0;
  const model::MachineSettings tried = with_gains(machine, joint, gains);
  FrequencyResponse response(tried, joint, reading_delay, PositionLoop::closed);
  const double Tp = machine.nc.periods.seconds(machine.nc.periods.position);
  const Curve one = curve_of(open_position(response), position_grid(tried, joint, reading_delay));
  return largest_gain(kMinKv, std::numbers::pi / Tp, [&](double Kv) {
    Curve curve = one;
    for (auto& L : curve.y) L *= Kv;
    return missed(margins_of(curve), wanted);
  });
}

// Largest Kv up to `most` with a quantity, rising with Kv, up to `bound`.
template <class Of>
double lowered(double most, double bound, const Of& quantity) {
  if (quantity(most) <= bound) return most;
  double good = 0.0, bad = most;
  Stage tried("gains tried", 0.0, Steps::unlike);
  while (bad - good > 1e-4 * most) {
    throw_if_interrupted();
    const double middle = 0.5 * (good + bad);
    (quantity(middle) <= bound ? good : bad) = middle;
    tried.advance();
  }
  return good;
}

double position_bandwidth(const model::MachineSettings& machine, int joint, Tick reading_delay) {
  FrequencyResponse response(machine, joint, reading_delay, PositionLoop::closed);
  const ResponseAt T = [&](double f) {
    return response.at(Entry::setpoint, f)[index_of(AxisSignal::position)];
  };
  return closed_loop_of(curve_of(T, position_grid(machine, joint, reading_delay)), T).bandwidth;
}

// Gains of one axis, from the inner loop to the outer.
class Tuner {
 public:
  Tuner(const model::MachineSettings& machine, int joint, Tick reading_delay,
        const TuneSettings& wanted)
      : machine_(machine),
        linear_(linearised(machine)),
        joint_(joint),
        reading_delay_(reading_delay),
        wanted_(wanted) {}

  Tuning tune() {
    out_.before = assess(machine_, joint_, reading_delay_);
    const double wv = velocity_bandwidth();
    Gains gains = velocity_gains(wv);
    const Largest Kv = largest_Kv(linear_, joint_, reading_delay_, gains, wanted_);
    if (Kv.gain == 0.0) no_gain(machine_, joint_, "Kv above 1 1/s", wanted_);
    out_.position = Kv.limit;
    try_calmer(wv, Kv.gain);
    gains.Kv = Kv.gain;
    lower_Kv(gains);
    keep_Kv(gains);
    return out_;
  }

 private:
  Gains gains_for(double wv) const { return {wv, wanted_.reset_ratio / wv, 1.0}; }

  // With the reset time as it is written.
  Gains rounded(double wv) const {
    Gains gains = gains_for(wv);
    gains.Tn = rounded_up(gains.Tn);
    return gains;
  }

  model::MachineSettings at_Kv(const Gains& gains, double Kv) const {
    Gains tried = gains;
    tried.Kv = Kv;
    return with_gains(linear_, joint_, tried);
  }

  std::optional<Limit> missed_with(const Gains& gains) const {
    return missed(velocity_margins(with_gains(linear_, joint_, gains), joint_), wanted_);
  }

  // The largest that keeps the margins of the velocity loop, up to --velocity-bandwidth.
  double velocity_bandwidth() {
    const double Tv = linear_.nc.periods.seconds(linear_.nc.periods.velocity);
    Largest wv = largest_gain(kMinBandwidth, std::numbers::pi / Tv,
                              [&](double one) { return missed_with(gains_for(one)); });
    if (wv.gain == 0.0) no_gain(machine_, joint_, "velocity_bandwidth above 20 rad/s", wanted_);
    if (wanted_.wv_most && *wanted_.wv_most < wv.gain) {
      wv = {*wanted_.wv_most, {Limit::Kind::most, 0.0}};
      if (missed_with(gains_for(wv.gain))) {
        no_gain(machine_, joint_, "velocity_bandwidth up to --velocity-bandwidth", wanted_);
      }
    }
    out_.velocity = wv.limit;
    return wv.gain;
  }

  Gains velocity_gains(double wv) {
    const double kept = kept_at(wv, [&](double one) { return !missed_with(rounded(one)); });
    if (kept == 0.0) no_gain(machine_, joint_, "velocity_bandwidth above 20 rad/s", wanted_);
    out_.wv_lowered = 1.0 - kept / rounded_down(wv);
    return rounded(kept);
  }

  // A slower velocity loop that lets Kv be larger.
  void try_calmer(double wv, double Kv) {
    for (const double share : kCalmer) {
      const double Kv_there =
          largest_Kv(linear_, joint_, reading_delay_, gains_for(share * wv), wanted_).gain;
      // A calmer velocity loop costs stiffness against cutting forces: it is only mentioned, and
      // only where Kv gains 5 %.
      if (Kv_there < kWorthIt * std::max(Kv, out_.calmer_Kv)) continue;
      out_.calmer_wv = share * wv;
      out_.calmer_Kv = Kv_there;
    }
  }

  // Down to the overshoot and the bandwidth that are wanted.
  void lower_Kv(Gains& gains) {
    const double calm = lowered(gains.Kv, wanted_.overshoot, [&](double one) {
      return step_overshoot(at_Kv(gains, one), joint_, reading_delay_);
    });
    if (calm < gains.Kv) out_.position = {Limit::Kind::overshoot, 0.0};
    gains.Kv = out_.Kv_limit = calm;
    if (!wanted_.bandwidth) return;
    const double enough = lowered(gains.Kv, *wanted_.bandwidth, [&](double one) {
      return position_bandwidth(at_Kv(gains, one), joint_, reading_delay_);
    });
    if (enough < gains.Kv) out_.position = {Limit::Kind::bandwidth, *wanted_.bandwidth};
    gains.Kv = enough;
  }

  void keep_Kv(const Gains& gains) {
    const double kept = kept_at(gains.Kv, [&](double one) {
      out_.after = assess(at_Kv(gains, one), joint_, reading_delay_);
      return keeps(out_.after, wanted_);
    });
    if (kept == 0.0) no_gain(machine_, joint_, "Kv above 1 1/s", wanted_);
    out_.Kv_lowered = 1.0 - kept / rounded_down(gains.Kv);
  }

  const model::MachineSettings& machine_;
  const model::MachineSettings linear_;
  int joint_;
  Tick reading_delay_;
  const TuneSettings& wanted_;
  Tuning out_;
};

}  // namespace

Gains gains_of(const model::MachineSettings& machine, int joint) {
  const controllers::CascadeParams& c = machine.nc.cascade[static_cast<std::size_t>(joint)];
  return {c.Kp / c.J, c.Ki > 0.0 ? c.Kp / c.Ki : 0.0, c.Kv};
}

model::MachineSettings with_gains(const model::MachineSettings& machine, int joint,
                                  const Gains& gains) {
  model::MachineSettings out = machine;
  controllers::CascadeParams& c = out.nc.cascade[static_cast<std::size_t>(joint)];
  c.Kp = gains.wv * c.J;
  c.Ki = gains.Tn > 0.0 ? c.Kp / gains.Tn : 0.0;
  c.Kv = gains.Kv;
  return out;
}

std::shared_ptr<const model::MachineSettings> shared_with_gains(
    const model::MachineSettings& machine, int joint, const Gains& gains) {
  return std::make_shared<const model::MachineSettings>(with_gains(machine, joint, gains));
}

bool keeps(const Assessment& a, const TuneSettings& wanted) {
  return a.stable && !missed(a.velocity, wanted) && !missed(a.position, wanted) &&
         a.overshoot <= wanted.overshoot;
}

Assessment assess(const model::MachineSettings& machine, int joint, Tick reading_delay) {
  const model::MachineSettings linear = linearised(machine);
  Assessment out;
  out.gains = gains_of(machine, joint);
  out.velocity = velocity_margins(linear, joint);
  FrequencyResponse response(linear, joint, reading_delay, PositionLoop::closed);
  const ResponseAt L = open_position(response);
  const ResponseAt T = [&](double f) {
    return response.at(Entry::setpoint, f)[index_of(AxisSignal::position)];
  };
  const auto f = position_grid(linear, joint, reading_delay);
  out.position = margins_of(curve_of(L, f), L);
  out.closed = closed_loop_of(curve_of(T, f), T);
  out.stable = velocity_spectral_radius(linear, joint) < 1.0 &&
               spectral_radius(linear, joint, reading_delay) < 1.0;
  if (!out.stable) return out;
  out.overshoot = step_overshoot(linear, joint, reading_delay);
  StepSettings load;
  load.kind = StepKind::load;
  load.amplitude = 1.0;
  load.duration = std::min(
      kLongestStep,
      kStepDuration * slowest_time_constant(linear, joint, reading_delay, PositionLoop::closed));
  out.load_peak = std::abs(step_response(linear, joint, reading_delay, load).figures.peak);
  return out;
}

Tuning tune(const model::MachineSettings& machine, int joint, Tick reading_delay,
            const TuneSettings& wanted) {
  return Tuner(machine, joint, reading_delay, wanted).tune();
}

Tuning with_common_Kv(const model::MachineSettings& machine, int joint, Tick reading_delay,
                      Tuning tuning, double Kv) {
  assert(Kv <= tuning.after.gains.Kv);
  Gains gains = tuning.after.gains;
  gains.Kv = Kv;
  tuning.after = assess(with_gains(machine, joint, gains), joint, reading_delay);
  return tuning;
}

}  // namespace servomill::sim::frequency

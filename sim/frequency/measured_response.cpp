#include "sim/frequency/measured_response.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

#include "plant/drives/feed_drive.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "sim/frequency/axis_dynamics.h"
#include "sim/frequency/axis_test_bench.h"
#include "sim/frequency/frequency_response.h"

namespace servomill::sim::frequency {
namespace {

constexpr double kDecay = 20.7;         // time constants to 1e-9
constexpr double kLongestWait = 60.0;   // s
constexpr double kMinWindow = 0.1;      // s
constexpr double kMinPeriods = 2.0;     // of the lowest frequency in a window of one sine
constexpr double kSharedPeriods = 6.0;  // of the lowest frequency in that of a multi-sine
constexpr Tick kMaxKept = 4'000'000;    // turns of a window that are computed once
constexpr double kCurrentShare = 0.02;

// Whole periods in whole hyperperiods.
struct Window {
  Tick hyperperiods = 1;
  std::vector<Tick> periods;  // one number a frequency
};

// A sinusoid whose mirror image the sampling folds onto itself cannot be distinguished from it.
bool folds_onto_itself(Tick periods, Tick hyperperiods) {
  return (2 * periods) % hyperperiods == 0;
}

Window window_of(double f, double T) {
  const Tick periods = static_cast<Tick>(std::ceil(std::max(kMinPeriods, f * kMinWindow)));
  Tick hyperperiods = std::max<Tick>(1, std::llround(static_cast<double>(periods) / (f * T)));
  while (folds_onto_itself(periods, hyperperiods)) ++hyperperiods;
  return {hyperperiods, {periods}};
}

Window window_of_all(const std::vector<double>& f, double T) {
  const double lowest = *std::min_element(f.begin(), f.end());
  Window window;
  window.hyperperiods =
      static_cast<Tick>(std::ceil(std::max(kMinWindow, kSharedPeriods / lowest) / T - 1e-6));
  for (const double one : f) {
    Tick periods =
        std::max<Tick>(1, std::llround(one * T * static_cast<double>(window.hyperperiods)));
    if (folds_onto_itself(periods, window.hyperperiods)) ++periods;
    if (window.periods.empty() || periods > window.periods.back()) {
      window.periods.push_back(periods);
    }
  }
  return window;
}

double frequency(const Window& window, std::size_t k, double T) {
  return static_cast<double>(window.periods[k]) / (static_cast<double>(window.hyperperiods) * T);
}

// Sum of sinusoids of one window on the ticks of the stand.
class Excitation {
 public:
  Excitation(const Window& window, const AxisTestBench& stand, const Measurement& how)
      : how_(how),
        h_(stand.base()),
        Tp_(stand.machine().nc.periods.seconds(stand.machine().nc.periods.position)),
        ticks_(window.hyperperiods * stand.hyperperiod()) {
    if (ticks_ <= kMaxKept) turn_.reserve(static_cast<std::size_t>(ticks_));
    for (Tick n = 0; n < ticks_ && ticks_ <= kMaxKept; ++n) turn_.push_back(turned(n));
    const double K = static_cast<double>(window.periods.size());
    for (std::size_t k = 0; k < window.periods.size(); ++k) {
      const double order = static_cast<double>(k);
      lines_.push_back({window.periods[k],
                        2.0 * std::numbers::pi * frequency(window, k, stand.period()),
                        std::polar(1.0, -std::numbers::pi * order * (order + 1.0) / K)});
    }
    double peak = 0.0;
    for (Tick n = 0; n < ticks_; ++n) peak = std::max(peak, std::abs(sum(n).real()));
    const double amplitude =
        std::min(how_.amplitude, how_.max_acceleration / (lines_.back().w * lines_.back().w));
    for (Line& line : lines_) line.amplitude *= amplitude / peak;
    crest_factor_ = peak / std::sqrt(0.5 * K);
  }

  double crest_factor() const { return crest_factor_; }
  std::size_t lines() const { return lines_.size(); }
  Complex amplitude(std::size_t k) const { return lines_[k].amplitude; }
  Complex turn(std::size_t k, Tick n) const {
    const Tick share = lines_[k].periods * (n % ticks_) % ticks_;
    return turn_.empty() ? turned(share) : turn_[static_cast<std::size_t>(share)];
  }

  StandInput at(Tick n) const {
    StandInput in;
    for (std::size_t k = 0; k < lines_.size(); ++k) {
      const StandInput one =
          sinusoid(how_.entry, lines_[k].amplitude * turn(k, n), lines_[k].w, h_, Tp_);
      in.q += one.q;
      in.dq += one.dq;
      in.ddq += one.ddq;
      in.added.force += one.added.force;
      in.added.velocity += one.added.velocity;
      in.added.current += one.added.current;
      in.added.reading += one.added.reading;
    }
    return in;
  }

 private:
  struct Line {
    Tick periods;
    double w;  // rad/s
    Complex amplitude;
  };
  Complex turned(Tick share) const {
    return std::polar(
        1.0, 2.0 * std::numbers::pi * static_cast<double>(share) / static_cast<double>(ticks_));
  }
  Complex sum(Tick n) const {
    Complex u = 0.0;
    for (std::size_t k = 0; k < lines_.size(); ++k) u += lines_[k].amplitude * turn(k, n);
    return u;
  }

  Measurement how_;
  double h_, Tp_;
  Tick ticks_;
  std::vector<Complex> turn_;  // of each tick; empty for a long window
  std::vector<Line> lines_;
  double crest_factor_ = 0.0;
};

// How far the signals are off the true ones, over a window.
class EncoderErrors {
 public:
  explicit EncoderErrors(AxisTestBench& stand)
      : stand_(stand),
        Tv_(stand.machine().nc.cascade[static_cast<std::size_t>(stand.joint())].Tv) {}

  AxisSignals at(std::uint8_t due, const AxisSignals& y) {
    AxisSignals errors{};
    const double speed = y[index_of(AxisSignal::motor_speed)];
    if (last_speed_) turned_ += 0.5 * stand_.base() * (*last_speed_ + speed);
    last_speed_ = speed;
    errors[index_of(AxisSignal::reading)] = errors[index_of(AxisSignal::position_error)] =
        stand_.scale_error();
    if (!(due & model::kVelocityLoop)) return errors;
    if (whole_period_) {
      errors[index_of(AxisSignal::measured_speed)] = errors[index_of(AxisSignal::speed_error)] =
          y[index_of(AxisSignal::measured_speed)] - turned_ / Tv_;
    }
    turned_ = 0.0;
    whole_period_ = true;
    return errors;
  }

 private:
  AxisTestBench& stand_;
  double Tv_;
  std::optional<double> last_speed_;
  double turned_ = 0.0;        // rad, true, since the last instant of the velocity loop
  bool whole_period_ = false;  // it has been seen
};

// Fundamentals of all lines of an excitation.
struct Lines {
  explicit Lines(std::size_t count) : sums(count), added(count) {}

  void add(const Excitation& excitation, Tick n, std::uint8_t due, const AxisSignals& y,
           const AxisSignals& errors) {
    for (std::size_t k = 0; k < sums.size(); ++k) {
      sums[k].add(due, y, std::conj(excitation.turn(k, n)));
      added[k].add(due, errors, std::conj(excitation.turn(k, n)));
    }
  }

  // Half the amplitude of a real sinusoid turns forward.
  MeasuredPoint point(std::size_t k, Complex amplitude) const {
    MeasuredPoint out;
    for (std::size_t s = 0; s < kAxisSignals; ++s) {
      out.response[s] = 2.0 * sums[k].mean()[s] / amplitude;
      out.added[s] = 2.0 * added[k].mean()[s] / amplitude;
    }
    return out;
  }

  std::vector<Fundamental> sums, added;
};

void measure_window(AxisTestBench& stand, PositionLoop loop, const Measurement& how,
                    const Window& window, Tick first, MeasuredResponse& out, Stage& stage) {
  const Excitation excitation(window, stand, how);
  const auto moved = [&, h = stand.base()](Tick n) {
    return how.position + how.velocity * h * static_cast<double>(n);
  };
  const auto feed = [&](Tick n) {
    StandInput in = excitation.at(n);
    in.q += moved(n);
    in.dq += how.velocity;
    if (loop == PositionLoop::open) in.added.velocity += how.velocity;
    return in;
  };
  Lines lines(excitation.lines());
  EncoderErrors encoders(stand);
  const auto add = [&](Tick n, std::uint8_t due, AxisSignals y) {
    y[index_of(AxisSignal::position)] -= moved(n);
    y[index_of(AxisSignal::reading)] -= moved(n);
    if (due & model::kVelocityLoop)
      out.current_limited = out.current_limited || stand.at_current_limit();
    out.peak_current = std::max(out.peak_current, std::abs(y[index_of(AxisSignal::current)]));
    lines.add(excitation, n, due, y, encoders.at(due, y));
  };

  stand.settle(how.position);
  const Tick H = stand.hyperperiod();
  for (Tick p = 0; p < first; ++p) {
    throw_if_interrupted();
    stage.advance();
    stand.run(p * H, feed, [](Tick, std::uint8_t, const AxisSignals&) {});
  }
  for (Tick p = first; p < first + window.hyperperiods; ++p) {
    throw_if_interrupted();
    stage.advance();
    stand.run(p * H, feed, add);
  }

  if (!out.fault) out.fault = stand.fault();
  out.crest_factor = excitation.crest_factor();
  out.simulated_time += static_cast<double>(first + window.hyperperiods) * stand.period();
  for (std::size_t k = 0; k < excitation.lines(); ++k) {
    out.points.push_back(lines.point(k, excitation.amplitude(k)));
    out.points.back().f = frequency(window, k, stand.period());
  }
}

// One window after the other, or one of all frequencies. Frequencies that meet are measured once.
std::vector<Window> windows_of(const std::vector<double>& wanted, Method method, double period) {
  if (method == Method::multi_sine) return {window_of_all(wanted, period)};
  std::vector<Window> out;
  for (const double f : wanted) {
    Window window = window_of(f, period);
    const bool is_new =
        out.empty() || frequency(window, 0, period) > frequency(out.back(), 0, period);
    if (is_new) out.push_back(std::move(window));
  }
  return out;
}

}  // namespace

bool resolved(const MeasuredPoint& point, AxisSignal output, AxisSignal input) {
  const auto small = [&](AxisSignal signal) {
    const std::size_t s = index_of(signal);
    return std::abs(point.added[s]) <= kMaxAdded * std::abs(point.response[s]);
  };
  return point.response[index_of(output)] != 0.0 && small(output) && small(input);
}

MeasuredResponse measure(const model::MachineSettings& machine, int joint, Tick reading_delay,
                         PositionLoop loop, const Measurement& how,
                         const std::vector<double>& wanted) {
  assert(how.amplitude > 0.0);
  AxisTestBench stand(machine, joint, reading_delay, loop);
  const double wait =
      std::min(kLongestWait, kDecay * slowest_time_constant(machine, joint, reading_delay, loop));
  const Tick first = static_cast<Tick>(std::ceil(wait / stand.period()));
  const std::vector<Window> windows = windows_of(wanted, how.method, stand.period());
  double hyperperiods = 0.0;
  for (const Window& window : windows) {
    hyperperiods += static_cast<double>(first + window.hyperperiods);
  }
  Stage stage("", hyperperiods);  // low frequencies take longer
  MeasuredResponse out;
  for (const Window& window : windows) {
    measure_window(stand, loop, how, window, first, out, stage);
  }
  return out;
}

double default_amplitude(const model::MachineSettings& machine, int joint, Entry entry) {
  const controllers::CascadeParams& c = machine.nc.cascade[static_cast<std::size_t>(joint)];
  const double current = kCurrentShare * c.i_max;
  switch (entry) {
    case Entry::setpoint:
    case Entry::setpoint_fed_forward:
    case Entry::offset:
    case Entry::reading:
      return current * c.Kt * c.r / (c.Kp * c.Kv);
    case Entry::velocity_command:
      return current * c.Kt * c.r / c.Kp;
    case Entry::current_command:
      return current;
    case Entry::force:
      return current * c.Kt / c.r;
  }
  return current;
}

double default_velocity(const model::MachineSettings& machine, int joint, Entry entry,
                        double amplitude) {
  const plant::FeedDriveParams& drive = machine.drives[static_cast<std::size_t>(joint)];
  if (drive.friction.kind == plant::FrictionKind::none && drive.gap == 0.0) return 0.0;
  // four times the velocity command that the amplitude asks for, or stands for
  constexpr double kAhead = 4.0;
  const double share = amplitude / default_amplitude(machine, joint, entry);
  return kAhead * share * default_amplitude(machine, joint, Entry::velocity_command);
}

}  // namespace servomill::sim::frequency

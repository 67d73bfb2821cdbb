/// Frequency response of one axis as an engineer measures it: fed with sinusoids, simulated with
/// everything that the scenario gives the axis (friction, backlash, quantisation, limits).
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "plant/vocabulary/ticks.h"
#include "sim/frequency/axis_signals.h"
#include "sim/model/forward.h"

namespace servomill::sim::frequency {

struct Measurement {
  Entry entry = Entry::setpoint;
  Method method = Method::sine;
  double amplitude = 0.0;  // peak of what is fed in, in the unit of the entry; > 0
  double max_acceleration = std::numeric_limits<double>::infinity();  // m/s^2: of a setpoint; it
                                                                      // lowers the amplitude
  double velocity = 0.0;  // m/s, rad/s: the axis moves on with it, so that friction does not stick
  double position = 0.0;  // m, rad: where it begins
};

struct MeasuredPoint {
  double f = 0.0;     // Hz
  Response response;  // for the amplitude 1
  // what the encoders add to it: reading less position, measured speed less the mean of the true
  // one over the velocity period; 0 for signals that no encoder reads
  Response added = {};
};

/// Largest share of input or output that encoder errors may add for their ratio to count as a
/// measurement.
inline constexpr double kMaxAdded = 0.1;
bool resolved(const MeasuredPoint& point, AxisSignal output, AxisSignal input);

struct MeasuredResponse {
  std::vector<MeasuredPoint> points;
  double crest_factor = 0.0;         // peak over effective value of what is fed in
  double peak_current = 0.0;         // A, after the transient
  double simulated_time = 0.0;       // s
  bool current_limited = false;      // the limit of the current was reached: not linear
  std::optional<std::string> fault;  // why a run would have stopped: the values are wrong
};

/// Waits until the slowest transient has decayed to 1e-9, then takes fundamentals. Frequencies are
/// moved to where whole periods fill whole hyperperiods: nothing leaks then, and what the sampling
/// adds is orthogonal. Several that meet in one are measured once. A steady velocity is subtracted
/// from position and reading.
///
/// A multi-sine has K equal amplitudes and the phases phi_k = -pi k (k - 1) / K.
/// Source: M. Schroeder, Synthesis of low-peak-factor signals and binary sequences with low
/// autocorrelation, IEEE Trans. Inf. Theory 16 (1970) 85, for equal power.
/// @param wanted  Hz, rising, below half the rate of the loop that is fed
/// @pre the loop is stable
MeasuredResponse measure(const model::MachineSettings& machine, int joint, Tick reading_delay,
                         PositionLoop loop, const Measurement& how,
                         const std::vector<double>& wanted);

/// Amplitude for which the velocity loop's proportional part takes 2 % of the current limit.
double default_amplitude(const model::MachineSettings& machine, int joint, Entry entry);

/// Velocity at which friction does not stick under that amplitude; 0 for an axis without friction
/// and backlash.
double default_velocity(const model::MachineSettings& machine, int joint, Entry entry,
                        double amplitude);

}  // namespace servomill::sim::frequency

/// The frequency responses that a servo engineer looks at, exact and measured, of one axis.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plant/vocabulary/ticks.h"
#include "sim/frequency/axis_signals.h"
#include "sim/frequency/margins.h"
#include "sim/model/forward.h"

namespace servomill::sim::frequency {

enum class BodeLoop : std::uint8_t { position, velocity, compliance };

/// One curve, exact on a grid for drawing and at the measured frequencies.
struct BodeCurve {
  std::string name;                         // "position_open"
  std::string long_name;                    // "open position loop"
  Curve exact;                              // dimensionless, or m/N
  std::vector<double> f;                    // Hz, of the table
  std::vector<Complex> exact_at, measured;  // at f; measured is empty if nothing was measured, NaN
                                            // where the encoders do not resolve it
};

/// One loop with what is read off its curves.
struct BodeResult {
  BodeLoop loop = BodeLoop::position;
  std::vector<BodeCurve> curves;
  bool stable = true;
  bool has_stable_velocity_loop = true;  // without the position loop
  double time_constant = 0.0;            // s, slowest; infinite if unstable
  double nyquist = 0.0;                  // Hz, half the rate of the loop
  Margins margins;                       // of position and velocity
  ClosedLoop closed;                     // of position and velocity; of compliance peak in m/N
  // of the measurement
  bool measured = false;
  Method method = Method::sine;
  double amplitude = 0.0, velocity = 0.0;         // SI of what is fed in; m/s
  double crest_factor = 0.0, peak_current = 0.0;  // -, A
  double simulated_time = 0.0;                    // s
  bool current_limited = false;      // the limit of the current was reached: not linear
  std::optional<std::string> fault;  // why a run would have stopped: nothing is kept as measured
};

/// Below it the simulation of two periods takes too long.
inline constexpr double kLowestMeasured = 0.1;  // Hz

struct BodeSettings {
  BodeLoop loop = BodeLoop::position;
  double from = 1.0;         // Hz
  std::optional<double> to;  // Hz; none: 0.4 times the rate of the loop
  std::size_t points = 30;
  bool measure = true;
  Method method = Method::sine;
  std::optional<double> amplitude;  // default_amplitude
  std::optional<double> velocity;   // default_velocity
};

/// Half the rate of the loop that the curves are about (Hz); a force acts on the position loop.
double nyquist_frequency(const model::LoopPeriods& periods, BodeLoop loop);

/// @pre 0 < from < to <= nyquist_frequency
BodeResult bode(const model::MachineSettings& machine, int joint, Tick reading_delay,
                const BodeSettings& settings);

/// Ticks between the scale and the position loop in the cases of a scenario: signal delay of the
/// feedback hardware if one of them has it.
Tick reading_delay_of(const model::Scenario& scenario);

}  // namespace servomill::sim::frequency

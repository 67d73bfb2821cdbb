/// Gains of one axis for wanted margins, on the exact multirate model.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "plant/vocabulary/ticks.h"
#include "plant/vocabulary/units.h"
#include "sim/frequency/margins.h"
#include "sim/model/forward.h"

namespace servomill::sim::frequency {

struct Gains {
  double wv = 0.0;  // rad/s, velocity bandwidth: Kp = wv J
  double Tn = 0.0;  // s, reset time; 0: no integral part
  double Kv = 0.0;  // 1/s
};

Gains gains_of(const model::MachineSettings& machine, int joint);
model::MachineSettings with_gains(const model::MachineSettings& machine, int joint,
                                  const Gains& gains);

/// The same for callers that need no complete MachineSettings.
std::shared_ptr<const model::MachineSettings> shared_with_gains(
    const model::MachineSettings& machine, int joint, const Gains& gains);

struct TuneSettings {
  double phase_margin = 60.0 * deg;  // rad, least, of both loops
  double gain_margin = 2.512;        // least, of both loops: 8 dB
  double overshoot = 0.05;           // most, of a step of the setpoint
  std::optional<double> bandwidth;   // Hz, wanted of the closed position loop; none: all there is
  std::optional<double> wv_most;     // rad/s, velocity bandwidth; none: all there is
  double reset_ratio = 4.0;          // Tn wv: the reset costs atan(1 / 4) = 14 deg at the crossover
};

/// Reason why a gain is not larger.
struct Limit {
  enum class Kind : std::uint8_t { phase_margin, gain_margin, overshoot, bandwidth, most, range };
  Kind kind = Kind::range;
  double frequency = 0.0;  // Hz, where the margin is
};

/// How an axis is, by the linear multirate model.
struct Assessment {
  Gains gains;
  bool stable = false;  // both loops, by eigenvalues
  Margins velocity, position;
  ClosedLoop closed;       // position, nothing fed forward
  double overshoot = 0.0;  // of a step of the setpoint
  double load_peak = 0.0;  // m/N: peak deviation after a load step
};
/// Stable, with all margins and no more overshoot than wanted.
bool keeps(const Assessment& assessment, const TuneSettings& wanted);
Assessment assess(const model::MachineSettings& machine, int joint, Tick reading_delay);

struct Tuning {
  Assessment before, after;
  Limit velocity, position;  // what binds
  double Kv_limit = 0.0;     // 1/s, largest Kv that keeps margins and overshoot
  // share by which velocity bandwidth and Kv were lowered once more, because the curve of the
  // result, looked at closely, missed a margin by a little
  double wv_lowered = 0.0, Kv_lowered = 0.0;
  // a lower velocity bandwidth whose margins of the position loop allow a higher Kv; 0: none found
  double calmer_wv = 0.0, calmer_Kv = 0.0;  // rad/s, 1/s
};

/// First the largest velocity bandwidth, Tn going along with it, for which every smaller one down
/// to the first that has the margins has them, too; then the largest Kv in the same way, lowered
/// until a step overshoots no more than wanted, or to the wanted bandwidth. Gains are rounded down
/// to four digits, assessed as rounded, and lowered further as long as the assessment misses a
/// margin.
/// @throws InputError that names the margin if no gain has it
Tuning tune(const model::MachineSettings& machine, int joint, Tick reading_delay,
            const TuneSettings& settings);

/// The same with this Kv instead of the largest one, not above it (interpolating axes need equal
/// ones).
Tuning with_common_Kv(const model::MachineSettings& machine, int joint, Tick reading_delay,
                      Tuning tuning, double Kv);

}  // namespace servomill::sim::frequency

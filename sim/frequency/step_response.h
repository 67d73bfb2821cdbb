/// Response of one axis to a step of its setpoint, of its velocity command or of a force.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "plant/vocabulary/ticks.h"
#include "sim/frequency/axis_signals.h"
#include "sim/model/forward.h"

namespace servomill::sim::frequency {

enum class StepKind : std::uint8_t {
  position,  // m, rad: of the setpoint, nothing fed forward
  velocity,  // m/s, rad/s: of the velocity command, position loop open
  load,      // N, N m: force on the slide along +x
};

struct StepSettings {
  StepKind kind = StepKind::position;
  double amplitude = 0.0;  // != 0
  double duration = 0.0;   // s, after the step
  double band = 0.02;      // of the amplitude, of a load step of the peak: settled within it
  double position = 0.0;   // m, rad: where the axis stands before
};

/// Figures of merit. Of a position step the slide counts, of a velocity step the motor as slide
/// velocity; of a load step the deviation of the slide.
struct StepFigures {
  double overshoot = 0.0;      // of the amplitude; 0 for a load step
  double rise_time = 0.0;      // s, from 10 % to 90 %; NaN if it does not get there
  double settling_time = 0.0;  // s, after which it stays within the band; NaN if never
  double steady_error = 0.0;   // m, m/s: amplitude less value at the end, of a load step deviation
  double peak = 0.0;           // m, m/s: farthest from the value before the step
  double peak_time = 0.0;      // s
};

struct StepResponse {
  std::vector<double> time;          // s, from the step on
  std::vector<AxisSignals> signals;  // position counted from where the axis stood
  StepFigures figures;
  double peak_current = 0.0;         // A
  std::optional<std::string> fault;  // why a run would have stopped: the values are wrong
};

/// The step comes at t = 0, at an instant of all loops; the axis has stood for long.
/// @param every  ticks between recorded rows
StepResponse step_response(const model::MachineSettings& machine, int joint, Tick reading_delay,
                           const StepSettings& settings, Tick every = 10);

/// Figures of merit of a recorded value y(t) that was 0 before.
StepFigures figures_of(StepKind kind, const std::vector<double>& time, const std::vector<double>& y,
                       double amplitude, double band);

}  // namespace servomill::sim::frequency

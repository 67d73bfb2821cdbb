/// Signals of one axis on a test stand: where it is excited, what is measured, and how.
#pragma once

#include <array>
#include <complex>
#include <cstddef>
#include <cstdint>

namespace servomill::sim::frequency {

/// Measured signal. Those marked (sampled) exist at the instants of their loop only.
enum class AxisSignal : std::uint8_t {
  position,        // m, rad: slide or table
  velocity,        // m/s: slide or table
  motor_speed,     // rad/s
  current,         // A
  reading,         // m: what the position loop reads (sampled)
  position_error,  // m: setpoint less reading (sampled)
  measured_speed,  // rad/s: what the velocity loop reads (sampled)
  speed_error,     // rad/s: command less measured speed (sampled)
};
inline constexpr std::size_t kAxisSignals = 8;
using AxisSignals = std::array<double, kAxisSignals>;
constexpr std::size_t index_of(AxisSignal signal) { return static_cast<std::size_t>(signal); }

enum class PositionLoop : std::uint8_t {
  closed,
  open,  // not run: the velocity command is what is injected
};

/// Point at which a sinusoid of amplitude 1 enters.
enum class Entry : std::uint8_t {
  setpoint,              // m, rad; its derivatives are not fed forward
  setpoint_fed_forward,  // the same with feed-forward as the NC has it
  offset,                // the same, its derivatives differences over a position period
  velocity_command,      // m/s, rad/s
  current_command,       // A
  force,                 // N, N m: on the slide, along +x
  reading,               // m, rad
};

enum class Method : std::uint8_t {
  sine,        // one frequency after the other
  multi_sine,  // all at once, phases after Schroeder
};

using Complex = std::complex<double>;

/// Fundamental of every signal as a complex amplitude.
using Response = std::array<Complex, kAxisSignals>;

/// Output over input.
inline Complex ratio(const Response& response, AxisSignal output, AxisSignal input) {
  return response[index_of(output)] / response[index_of(input)];
}

}  // namespace servomill::sim::frequency

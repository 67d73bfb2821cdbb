#include "sim/input/read_encoder.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "plant/vocabulary/units.h"
#include "sim/input/read_errors.h"
#include "sim/input/read_machine.h"

namespace servomill::sim::input {
namespace {

constexpr double kAnyLimit = std::numeric_limits<double>::infinity();

// Signal period: as a length or an angle, or as periods per revolution.
double read_period(config::Reader& table, config::Quantity position) {
  if (position == config::kAngle && table.has("periods_per_revolution")) {
    const double periods =
        table.real("periods_per_revolution", config::kNumber, {config::at_least(1.0)});
    if (table.has("period")) table.fault("period", "is already given by periods_per_revolution");
    return 2.0 * std::numbers::pi / periods;
  }
  return table.real("period", position, {config::above(0.0)});
}

plant::EncoderParams read_encoder(config::Reader& table, config::Quantity position) {
  plant::EncoderParams e;
  const std::size_t before = table.faults();
  e.period = read_period(table, position);
  const double subdivision =
      table.real_or("subdivision", 0.0, config::kNumber, {config::at_least(0.0)});
  e.step = subdivision > 0.0 ? e.period / subdivision : 0.0;
  e.sine_offset = table.real_or("sine_offset", 0.0, config::kNumber);
  e.cosine_offset = table.real_or("cosine_offset", 0.0, config::kNumber);
  e.imbalance = table.real_or("imbalance", 0.0, config::kNumber);
  e.quadrature_error = table.real_or("quadrature_error", 0.0, config::kAngle);
  e.harmonic[0].amplitude = table.real_or("harmonic_1", 0.0, position);
  e.harmonic[0].phase = table.real_or("harmonic_1_phase_deg", 0.0, config::kAngle);
  e.harmonic[1].amplitude = table.real_or("harmonic_2", 0.0, position);
  e.harmonic[1].phase = table.real_or("harmonic_2_phase_deg", 0.0, config::kAngle);
  e.signal_noise = table.real_or("signal_noise", 0.0, config::kNumber, {config::at_least(0.0)});
  e.position_noise = table.real_or("position_noise", 0.0, position, {config::at_least(0.0)});
  e.frequency_limit =
      table.real_or("frequency_limit_kHz", kAnyLimit, config::kRate, {config::above(0.0)});
  if (table.faults() > before) return {};
  const auto faults = plant::implausible(e);
  for (const std::string& rule : faults) table.fault(rule);
  return faults.empty() ? e : plant::EncoderParams{};
}

// An encoder as a table, or by its measuring step alone.
plant::Encoder read_either(config::Reader& axis, std::string_view table_key,
                           std::string_view step_key, config::Quantity position,
                           const plant::NoiseKey& noise, plant::EncoderParams& params) {
  if (!axis.has(table_key)) {
    return plant::Encoder::with_step(
        axis.real_or(step_key, 0.0, position, {config::at_least(0.0)}));
  }
  if (axis.has(step_key)) {
    axis.raw(step_key);  // of the machine's file; a table says more
  }
  config::Reader table = axis.table(table_key);
  params = read_encoder(table, position);
  return plant::Encoder(params, noise);
}

void read_marks(config::Reader& axis, int joint, const plant::EncoderParams& scale,
                model::MachineSettings& machine) {
  if (!axis.has("marks")) return;
  const auto j = static_cast<std::size_t>(joint);
  const bool linear = joint < kLinearJoints;
  const config::Quantity position = quantities_of(linear).position;
  const std::size_t before = axis.faults();
  config::Reader table = axis.table("marks");
  const auto N = static_cast<int>(
      table.integer_or("increment", 1000, {config::at_least(4.0), config::at_most(1e6)}));
  const auto allowed =
      static_cast<int>(table.integer_or("allowed_periods", 0, {config::at_least(0.0)}));
  const double lower = linear ? table.real_or("from", machine.nc.lower[joint], position) : 0.0;
  const double upper = linear ? table.real_or("to", machine.nc.upper[joint], position) : 0.0;
  if (axis.faults() > before) return;
  if (scale.period == 0.0) {
    axis.fault("marks", "needs the signal period of a table 'scale'");
    return;
  }
  if (linear && !(std::isfinite(lower) && std::isfinite(upper) && lower < upper)) {
    table.fault("needs 'from' and 'to', from < to, on an axis without travel");
    return;
  }
  const plant::MarkParams marks =
      linear ? plant::marks_of_scale(scale.period, N, lower, upper)
             : plant::marks_of_revolution(
                   static_cast<int>(std::lround(2.0 * std::numbers::pi / scale.period)), N);
  const auto faults = plant::implausible(marks);
  for (const std::string& rule : faults) table.fault(rule);
  if (faults.empty()) machine.marks[j] = model::MarkSettings{marks, allowed};
}

void read_screw(config::Reader& axis, int joint, model::MachineSettings& machine) {
  if (!axis.has("screw")) return;
  const auto j = static_cast<std::size_t>(joint);
  config::Reader table = axis.table("screw");
  plant::ScrewError& screw = machine.screw[j];
  if (table.has("lead_error")) {
    config::Reader lead = table.table("lead_error");
    screw.lead = read_length_function(lead);
  }
  plant::ScrewGrowth& growth = screw.growth;
  growth.alpha =
      table.real_or("expansion", growth.alpha, config::kExpansion, {config::at_least(0.0)});
  growth.x_fixed = table.real_or("fixed_at", 0.0, config::kLength);
  growth.dT_end = table.real_or("temperature_rise", 0.0, config::kTemperature);
  growth.tau = table.real_or("thermal_time_constant", 0.0, config::kTime, {config::at_least(0.0)});
  if (joint >= kLinearJoints) axis.fault("screw", "belongs to a linear axis");
}

}  // namespace

void read_encoders(config::Reader& axis, int joint, std::uint64_t noise_seed,
                   model::MachineSettings& machine) {
  const auto j = static_cast<std::size_t>(joint);
  const bool linear = joint < kLinearJoints;
  const bool linear_motor = linear && machine.drives[j].kind == plant::DriveKind::direct;
  const auto stream = [&](std::uint32_t n) {
    return plant::NoiseKey{noise_seed, 2 * static_cast<std::uint32_t>(joint) + n};
  };
  plant::EncoderParams scale, motor;
  machine.scale[j] =
      read_either(axis, "scale", "scale_step", quantities_of(linear).position, stream(0), scale);
  machine.motor[j] = read_either(axis, "motor", "motor_step",
                                 linear_motor ? config::kLength : config::kAngle, stream(1), motor);
  read_marks(axis, joint, scale, machine);
  read_screw(axis, joint, machine);
}

}  // namespace servomill::sim::input

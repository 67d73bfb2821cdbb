#include "sim/input/read_servo.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/input/read_machine.h"

namespace servomill::sim::input {
namespace {

using controllers::PositionFeedback;

constexpr std::array<std::string_view, 3> kFeedbacks = {"scale", "motor", "crossover"};
constexpr std::array<std::string_view, 4> kFilterTypes = {"notch", "low_pass", "low_pass_2",
                                                          "lead_lag"};
constexpr config::Quantity kCurrentRate{.s = -1, .A = 1};

controllers::CascadeParams read_cascade(config::Reader& axis,
                                        const controllers::CascadeParams& common,
                                        const plant::FeedDriveParams& p, bool linear,
                                        const model::LoopPeriods& periods) {
  const AxisQuantities& q = quantities_of(linear);
  controllers::CascadeParams c = common;
  c.Kv = axis.real_or("Kv", common.Kv, config::kRate, {config::above(0.0)});
  c.kvf =
      axis.real_or("velocity_feed_forward", common.kvf, config::kNumber, {config::at_least(0.0)});
  c.kaf = axis.real_or("acceleration_feed_forward", common.kaf, config::kNumber,
                       {config::at_least(0.0)});
  c.J = p.J_total();
  c.Kp = axis.real("velocity_bandwidth", config::kAngularVelocity, {config::above(0.0)}) * c.J;
  const double Tn =
      axis.real_or("velocity_reset_time_ms", 0.0, config::kTime, {config::at_least(0.0)});
  c.Ki = Tn > 0.0 ? c.Kp / Tn : 0.0;
  c.r = p.r;
  c.Kt = p.Kt;
  c.i_max = p.i_max;
  c.Tv = periods.seconds(periods.velocity);
  c.v_max =
      axis.real_or("velocity_command_max", controllers::kNoLimit, q.velocity, {config::above(0.0)});
  c.tau_max =
      axis.real_or("torque_max", controllers::kNoLimit, config::kTorque, {config::above(0.0)});
  c.di_max =
      axis.real_or("current_slew", controllers::kNoLimit, kCurrentRate, {config::above(0.0)});
  return c;
}

// A frequency that a filter of the velocity loop can have; a harmless one if it has not.
double filter_frequency(config::Reader& filter, std::string_view key, double Tv) {
  const std::size_t before = filter.faults();
  const double f = filter.real(key, config::kRate, {config::above(0.0)});
  if (filter.faults() == before && controllers::can_filter(f, Tv)) return f;
  if (filter.faults() == before) {
    filter.fault(key, fmt::format("must be < {:g} Hz, half the rate of the velocity loop",
                                  controllers::nyquist_frequency(Tv)));
  }
  return 0.1 * controllers::nyquist_frequency(Tv);
}

controllers::Biquad read_filter_section(config::Reader& filter, double Tv) {
  const std::size_t before = filter.faults();
  const std::size_t type = filter.choice("type", kFilterTypes);
  if (filter.faults() > before) {
    filter.skip_rest();
    return {};
  }
  if (kFilterTypes[type] == "lead_lag") {
    const double zero = filter_frequency(filter, "zero_Hz", Tv);
    const double pole = filter_frequency(filter, "pole_Hz", Tv);
    return controllers::lead_lag(zero, pole, Tv);
  }
  const double f = filter_frequency(filter, "frequency_Hz", Tv);
  if (kFilterTypes[type] == "low_pass") return controllers::low_pass(f, Tv);
  if (kFilterTypes[type] == "low_pass_2") {
    return controllers::low_pass(
        f, filter.real_or("damping", std::sqrt(0.5), config::kNumber, {config::above(0.0)}), Tv);
  }
  const double width = filter.real("width_Hz", config::kRate, {config::above(0.0)});
  const double depth = filter.real_or("depth_dB", 20.0, config::kNumber, {config::above(0.0)});
  const double damping = width > 0.0 ? 0.5 * width / f : 1.0;
  return controllers::notch(f, damping * std::pow(10.0, -depth / 20.0), damping, Tv);
}

controllers::CurrentLoopParams read_current_loop(config::Reader& axis,
                                                 const plant::FeedDriveParams& drive,
                                                 const model::LoopPeriods& periods) {
  controllers::CurrentLoopParams c;
  if (!axis.has("winding")) return c;
  config::Reader winding = axis.table("winding");
  const double bandwidth =
      winding.real("bandwidth", config::kAngularVelocity, {config::above(0.0)});
  const double Tn = winding.real_or("reset_time_ms", 0.0, config::kTime, {config::at_least(0.0)});
  c.u_max =
      winding.real_or("voltage_max", controllers::kNoLimit, config::kVoltage, {config::above(0.0)});
  c.Kp = drive.L * bandwidth;
  c.Ki = Tn > 0.0 ? c.Kp / Tn : 0.0;
  c.Ti = periods.seconds(periods.current);
  return c;
}

controllers::PositionFeedbackParams read_feedback(config::Reader& axis, const CommonServo& common,
                                                  const model::LoopPeriods& periods) {
  const double Tp = periods.seconds(periods.position);
  const auto kind = static_cast<PositionFeedback>(
      axis.choice_or("position_feedback", static_cast<std::size_t>(common.feedback), kFeedbacks));
  const double f =
      axis.real_or("crossover_Hz", common.crossover, config::kRate, {config::above(0.0)});
  if (kind == PositionFeedback::scale) return controllers::scale_feedback();
  if (kind == PositionFeedback::motor) return controllers::motor_feedback();
  if (controllers::can_filter(f, Tp)) return controllers::crossover_feedback(f, Tp);
  const std::string rule = fmt::format("must be < {:g} Hz, half the rate of the position loop",
                                       controllers::nyquist_frequency(Tp));
  if (axis.has("crossover_Hz")) {
    axis.fault("crossover_Hz", rule);
  } else if (f > 0.0) {
    axis.fault(fmt::format("nc.crossover_Hz = {:g}; {}", f, rule));
  } else {
    axis.fault("position_feedback = \"crossover\" needs crossover_Hz");
  }
  return controllers::scale_feedback();
}

controllers::FrictionCompensationParams read_friction_compensation(
    config::Reader& axis, const plant::FeedDriveParams& drive, bool linear, double Tv) {
  controllers::FrictionCompensationParams c;
  if (!axis.has("friction_compensation")) return c;
  const AxisQuantities& q = quantities_of(linear);
  config::Reader table = axis.table("friction_compensation");
  const double plus = table.real("coulomb", q.force, {config::at_least(0.0)});
  const double minus = table.real_or("coulomb_negative", plus, q.force, {config::at_least(0.0)});
  c.tau_plus = drive.r * plus;
  c.tau_minus = drive.r * minus;
  c.v_switch = table.real_or("switch_velocity", 0.0, q.velocity, {config::at_least(0.0)});
  c.tau_pulse = drive.r * table.real_or("reversal_pulse", 0.0, q.force);
  c.reversal_pulse_time = table.real_or("reversal_pulse_time_ms", controllers::kNoLimit,
                                        config::kTime, {config::above(0.0)});
  c.reversal_pulse_distance = table.real_or("reversal_pulse_distance", controllers::kNoLimit,
                                            q.position, {config::above(0.0)});
  c.Tv = Tv;
  if (c.tau_pulse != 0.0 && !table.has("reversal_pulse_time_ms") &&
      !table.has("reversal_pulse_distance")) {
    table.fault("reversal_pulse",
                "needs reversal_pulse_time_ms or reversal_pulse_distance, over which it decays");
  }
  return c;
}

controllers::BacklashCompensationParams read_backlash_compensation(config::Reader& axis,
                                                                   bool linear, double Tp) {
  controllers::BacklashCompensationParams c;
  if (!axis.has("backlash_compensation")) return c;
  const AxisQuantities& q = quantities_of(linear);
  config::Reader table = axis.table("backlash_compensation");
  c.width = table.real("width", q.position);
  c.time = table.real_or("time_ms", 15 * ms, config::kTime, {config::above(0.0)});
  c.hysteresis = table.real_or("hysteresis", c.hysteresis, q.position, {config::at_least(0.0)});
  c.Tp = Tp;
  return c;
}

controllers::SupervisionParams read_supervision(config::Reader& axis, const CommonServo& common,
                                                bool linear, double Tp) {
  const config::Quantity length = quantities_of(linear).position;
  controllers::SupervisionParams s;
  s.following_error =
      axis.real_or("following_error_limit",
                   linear ? common.following_error_linear : common.following_error_rotary, length,
                   {config::above(0.0)});
  s.standstill =
      axis.real_or("standstill_limit", controllers::kNoLimit, length, {config::above(0.0)});
  s.standstill_delay =
      axis.real_or("standstill_delay_ms", 100 * ms, config::kTime, {config::at_least(0.0)});
  s.encoder_difference =
      axis.real_or("encoder_difference_limit", controllers::kNoLimit, length, {config::above(0.0)});
  s.Tp = Tp;
  return s;
}

}  // namespace

controllers::FilterChain read_filters(config::Reader& table, double period) {
  controllers::FilterChain chain;
  const std::size_t before = table.faults();
  for (config::Reader& filter : table.tables_or_none("filter")) {
    const controllers::Biquad section = read_filter_section(filter, period);
    if (chain.count < controllers::kMaxSections) {
      chain.append(section);
    } else if (table.faults() == before) {
      table.fault(fmt::format("has more than {} tables 'filter'", controllers::kMaxSections));
    }
  }
  return chain;
}

CommonServo read_common_servo(config::Reader& nc) {
  CommonServo common;
  controllers::CascadeParams& c = common.cascade;
  c.Kv = nc.real("Kv", config::kRate, {config::above(0.0)});
  c.kvf = nc.real_or("velocity_feed_forward", 1.0, config::kNumber, {config::at_least(0.0)});
  c.kaf = nc.real_or("acceleration_feed_forward", 1.0, config::kNumber, {config::at_least(0.0)});
  common.feedback = static_cast<PositionFeedback>(nc.choice_or("position_feedback", 0, kFeedbacks));
  common.crossover = nc.real_or("crossover_Hz", 0.0, config::kRate, {config::above(0.0)});
  common.following_error_linear =
      nc.real_or("following_error_limit_mm", 10 * mm, config::kLength, {config::above(0.0)});
  common.following_error_rotary =
      nc.real_or("following_error_limit_deg", 0.5 * deg, config::kAngle, {config::above(0.0)});
  return common;
}

void read_servo(config::Reader& axis, const CommonServo& common, int joint,
                model::MachineSettings& machine) {
  const auto j = static_cast<std::size_t>(joint);
  const bool linear = joint < kLinearJoints;
  const plant::FeedDriveParams& drive = machine.drives[j];
  const model::LoopPeriods& periods = machine.nc.periods;
  const double Tp = periods.seconds(periods.position), Tv = periods.seconds(periods.velocity);
  controllers::CascadeParams& cascade = machine.nc.cascade[j];
  cascade = read_cascade(axis, common.cascade, drive, linear, periods);
  cascade.filters = read_filters(axis, cascade.Tv);
  model::AxisFunctions& functions = machine.nc.functions[j];
  functions.current_loop = read_current_loop(axis, drive, periods);
  functions.position_feedback = read_feedback(axis, common, periods);
  functions.friction = read_friction_compensation(axis, drive, linear, Tv);
  functions.backlash = read_backlash_compensation(axis, linear, Tp);
  functions.supervision = read_supervision(axis, common, linear, Tp);
}

}  // namespace servomill::sim::input

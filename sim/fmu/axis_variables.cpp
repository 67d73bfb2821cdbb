#include "sim/fmu/axis_variables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>

namespace servomill::sim::fmu {
namespace {

// In the order of kVariableTable; an input or output of FMI keeps its number from version to
// version.
enum Reference : std::uint32_t {
  kTime,
  kSetpoint,
  kVelocityFeedForward,
  kAccelerationFeedForward,
  kLoad,
  kFeedbackDisplacement,
  kPosition,
  kPositionMeasured,
  kVelocity,
  kCurrent,
  kTorque,
  kPositionFeedback,
  kFollowingError,
  kKv,
  kKvf,
  kKaf,
  kKp,
  kKi,
  kInertia,
  kMass,
  kFriction,
  kBasePeriod,
  kPositionPeriod,
  kReadingDelay,
};

constexpr auto kInput = Causality::input, kOutput = Causality::output,
               kParameter = Causality::parameter, kLocal = Causality::local;
constexpr auto kContinuous = Variability::continuous, kDiscrete = Variability::discrete,
               kFixed = Variability::fixed, kConstant = Variability::constant;

constexpr std::array<Variable, kVariables> kVariableTable = {{
    {kTime, "time", Causality::independent, kContinuous, Kind::time, "simulated time"},
    {kSetpoint, "position_setpoint", kInput, kContinuous, Kind::position,
     "setpoint of the position loop, sampled each position period"},
    {kVelocityFeedForward, "velocity_setpoint", kInput, kContinuous, Kind::velocity,
     "velocity that is fed forward (times velocity_feed_forward), sampled likewise"},
    {kAccelerationFeedForward, "acceleration_setpoint", kInput, kContinuous, Kind::acceleration,
     "acceleration that is fed forward (times acceleration_feed_forward), sampled likewise"},
    {kLoad, "load", kInput, kContinuous, Kind::force,
     "external force on the slide (torque on the table), towards +"},
    {kFeedbackDisplacement, "feedback_displacement", kInput, kContinuous, Kind::position,
     "virtual displacement that is added to the reading of the scale"},
    {kPosition, "position", kOutput, kContinuous, Kind::position, "position of the slide"},
    {kPositionMeasured, "position_measured", kOutput, kContinuous, Kind::position,
     "position of the slide as its scale reads it"},
    {kVelocity, "velocity", kOutput, kContinuous, Kind::velocity, "velocity of the slide"},
    {kCurrent, "current", kOutput, kContinuous, Kind::current, "torque-forming motor current"},
    {kTorque, "torque", kOutput, kContinuous, Kind::motor_torque, "motor torque (force)"},
    {kPositionFeedback, "position_feedback", kOutput, kDiscrete, Kind::position,
     "position as the position loop read it last"},
    {kFollowingError, "following_error", kOutput, kDiscrete, Kind::position,
     "setpoint minus position feedback in the last position period"},
    {kKv, "Kv", kParameter, kFixed, Kind::rate, "position gain"},
    {kKvf, "velocity_feed_forward", kParameter, kFixed, Kind::ratio,
     "share of the velocity that is fed forward"},
    {kKaf, "acceleration_feed_forward", kParameter, kFixed, Kind::ratio,
     "share of the acceleration that is fed forward"},
    {kKp, "velocity_gain", kParameter, kFixed, Kind::velocity_gain,
     "proportional gain of the velocity loop, at the motor"},
    {kKi, "integral_gain", kParameter, kFixed, Kind::integral_gain,
     "integral gain of the velocity loop: proportional gain over reset time; 0: no integral part"},
    {kInertia, "motor_inertia", kParameter, kFixed, Kind::motor_inertia,
     "inertia of motor and screw (mass of the primary part)"},
    {kMass, "moving_mass", kParameter, kFixed, Kind::moving_mass,
     "mass of the slide (inertia of the table) with everything it carries"},
    {kFriction, "friction_factor", kParameter, kFixed, Kind::ratio,
     "factor on the friction of the guideway: Coulomb, breakaway, viscous of a direction, "
     "bristles"},
    {kBasePeriod, "base_period", kLocal, kConstant, Kind::time,
     "base period, at whole multiples of which the loops are sampled"},
    {kPositionPeriod, "position_period", kLocal, kConstant, Kind::time,
     "period of the position loop"},
    {kReadingDelay, "reading_delay", kLocal, kConstant, Kind::time,
     "delay between the scale and the reading of the position loop"},
}};

constexpr bool numbered_in_order() {
  for (std::uint32_t n = 0; n < kVariables; ++n) {
    if (kVariableTable[n].reference != n) return false;
  }
  return true;
}
static_assert(numbered_in_order());

using Units = std::array<Unit, kKinds>;
// In the order of Kind.
constexpr Units kLinearUnits = {{{.name = "s", .s = 1},
                                 {.name = "m", .m = 1},
                                 {.name = "m/s", .m = 1, .s = -1},
                                 {.name = "m/s2", .m = 1, .s = -2},
                                 {.name = "N", .kg = 1, .m = 1, .s = -2},
                                 {.name = "A", .A = 1},
                                 {.name = "1/s", .s = -1},
                                 {.name = "1"},
                                 {.name = "N.m", .kg = 1, .m = 2, .s = -2},
                                 {.name = "kg.m2", .kg = 1, .m = 2},
                                 {.name = "kg", .kg = 1},
                                 {.name = "N.m.s/rad", .kg = 1, .m = 2, .s = -1, .rad = -1},
                                 {.name = "N.m/rad", .kg = 1, .m = 2, .s = -2, .rad = -1}}};

constexpr Unit& at(Units& units, Kind kind) { return units[static_cast<std::size_t>(kind)]; }

constexpr Units rotary_units() {
  Units units = kLinearUnits;
  at(units, Kind::position) = {.name = "rad", .rad = 1};
  at(units, Kind::velocity) = {.name = "rad/s", .s = -1, .rad = 1};
  at(units, Kind::acceleration) = {.name = "rad/s2", .s = -2, .rad = 1};
  at(units, Kind::force) = at(units, Kind::motor_torque);
  at(units, Kind::moving_mass) = at(units, Kind::motor_inertia);
  return units;
}

constexpr Units linear_motor_units() {
  Units units = kLinearUnits;
  at(units, Kind::motor_torque) = at(units, Kind::force);
  at(units, Kind::motor_inertia) = at(units, Kind::moving_mass);
  at(units, Kind::velocity_gain) = {.name = "N.s/m", .kg = 1, .s = -1};
  at(units, Kind::integral_gain) = {.name = "N/m", .kg = 1, .s = -2};
  return units;
}

constexpr Units kRotaryUnits = rotary_units(), kLinearMotorUnits = linear_motor_units();

// The first parameter beyond its range, with the rule; empty if there is none.
std::string parameter_fault(const Values& values) {
  struct Rule {
    Reference reference;
    bool positive;  // else it may be 0
  };
  constexpr Rule kRules[] = {{kKv, true},  {kKvf, false},    {kKaf, false}, {kKp, true},
                             {kKi, false}, {kInertia, true}, {kMass, true}, {kFriction, true}};
  for (const Rule& rule : kRules) {
    const double value = values[rule.reference];
    if (std::isfinite(value) && (rule.positive ? value > 0.0 : value >= 0.0)) continue;
    return fmt::format("{} = {:g}; must be {} 0", kVariableTable[rule.reference].name, value,
                       rule.positive ? ">" : ">=");
  }
  return {};
}

void scale(plant::FrictionParams& f, double factor) {
  for (double* force : {&f.Fc_positive, &f.Fc_negative, &f.Fs_positive, &f.Fs_negative,
                        &f.b_positive, &f.b_negative, &f.sigma0, &f.sigma1}) {
    *force *= factor;
  }
}

}  // namespace

std::span<const Variable> variables() { return kVariableTable; }

std::uint32_t reference_of(std::string_view name) {
  const auto found = std::find_if(kVariableTable.begin(), kVariableTable.end(),
                                  [&](const Variable& one) { return one.name == name; });
  assert(found != kVariableTable.end());
  return found->reference;
}

const Unit& unit_of(Kind kind, const AxisConstants& axis) {
  const Units& units = !axis.linear()        ? kRotaryUnits
                       : axis.linear_motor() ? kLinearMotorUnits
                                             : kLinearUnits;
  return units[static_cast<std::size_t>(kind)];
}

const Unit& linear_unit_of(Kind kind) { return kLinearUnits[static_cast<std::size_t>(kind)]; }

Values start_values(const AxisConstants& axis) {
  Values values{};
  const controllers::CascadeParams& c = axis.cascade();
  values[kKv] = c.Kv;
  values[kKvf] = c.kvf;
  values[kKaf] = c.kaf;
  values[kKp] = c.Kp;
  values[kKi] = c.Ki;
  values[kInertia] = axis.drive().J;
  values[kMass] = axis.drive().M;
  values[kFriction] = 1.0;
  const model::LoopPeriods& periods = axis.machine.nc.periods;
  values[kBasePeriod] = periods.base;
  values[kPositionPeriod] = periods.seconds(periods.position);
  values[kReadingDelay] = periods.seconds(axis.reading_delay);
  return values;
}

AxisInputs inputs_of(const Values& values) {
  return {values[kSetpoint], values[kVelocityFeedForward], values[kAccelerationFeedForward],
          values[kLoad], values[kFeedbackDisplacement]};
}

void put(const AxisOutputs& outputs, double time, Values& values) {
  values[kTime] = time;
  values[kPosition] = outputs.position;
  values[kPositionMeasured] = outputs.position_measured;
  values[kVelocity] = outputs.velocity;
  values[kCurrent] = outputs.current;
  values[kTorque] = outputs.torque;
  values[kPositionFeedback] = outputs.position_feedback;
  values[kFollowingError] = outputs.following_error;
}

AxisConstants with_parameters(AxisConstants axis, const Values& values, std::string& fault) {
  controllers::CascadeParams& c = axis.cascade();
  c.Kv = values[kKv];
  c.kvf = values[kKvf];
  c.kaf = values[kKaf];
  c.Kp = values[kKp];
  c.Ki = values[kKi];
  axis.drive().J = values[kInertia];
  axis.drive().M = values[kMass];
  scale(axis.drive().friction, values[kFriction]);
  std::string found = parameter_fault(values);
  const std::vector<std::string> rules = plant::implausible(axis.drive());
  if (found.empty() && !rules.empty()) found = rules.front();
  if (!found.empty()) fault = found;
  return axis;
}

}  // namespace servomill::sim::fmu

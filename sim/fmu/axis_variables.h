/// Variables of an exported axis: the only list. Model description, values and help follow from it.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "sim/fmu/axis_constants.h"
#include "sim/fmu/axis_simulation.h"

namespace servomill::sim::fmu {

/// Role of a variable, in the words of FMI.
enum class Causality : std::uint8_t { independent, parameter, input, output, local };
/// `discrete` changes at instants of the loops only.
enum class Variability : std::uint8_t { constant, fixed, discrete, continuous };

/// Physical kind of a variable. Its unit depends on the axis: m or rad, N or N m.
enum class Kind : std::uint8_t {
  time,
  position,
  velocity,
  acceleration,
  force,
  current,
  rate,           // 1/s
  ratio,          // 1
  motor_torque,   // N m; N of a linear motor
  motor_inertia,  // kg m^2; kg of a linear motor
  moving_mass,    // kg, kg m^2
  velocity_gain,  // N m s/rad; N s/m of a linear motor
  integral_gain,  // N m/rad; N/m of a linear motor
};
inline constexpr std::size_t kKinds = 13;

struct Variable {
  std::uint32_t reference;  // FMI's value reference
  std::string_view name;
  Causality causality;
  Variability variability;
  Kind kind;
  std::string_view description;
};

/// Distance between the value references of several axes.
inline constexpr std::uint32_t kAxisStride = 100;

/// Sorted by reference, which are 0, 1, ...
std::span<const Variable> variables();
/// The number of one of them. @pre there is one of that name
std::uint32_t reference_of(std::string_view name);

/// A unit by its powers of the base units.
struct Unit {
  std::string_view name;
  int kg = 0, m = 0, s = 0, A = 0, rad = 0;
};
const Unit& unit_of(Kind kind, const AxisConstants& axis);
/// The unit for a linear axis with a rotary motor, and for the tool.
const Unit& linear_unit_of(Kind kind);

inline constexpr std::size_t kVariables = 24;
/// By value reference; of outputs not used.
using Values = std::array<double, kVariables>;

/// Values before anything is set.
Values start_values(const AxisConstants& axis);
/// Inputs among the values.
AxisInputs inputs_of(const Values& values);
/// Writes the outputs and the time among the values.
void put(const AxisOutputs& outputs, double time, Values& values);

/// The axis with the parameters among the values.
/// @param fault  set to the rule that one of them breaks, else left as it is
AxisConstants with_parameters(AxisConstants axis, const Values& values, std::string& fault);

}  // namespace servomill::sim::fmu

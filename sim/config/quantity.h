/// Physical quantities of input files: dimensions, unit spellings, conversion to SI.
///
/// A unit is written as a product of symbols of one table (quantity.cpp): "mm", "m/min/mm",
/// "kg m^2", "Nm/rad", "mm/s^2", "1/s". In the name of a key the same unit reads `mm`,
/// `m_per_min_per_mm`, `kg_m2`, `Nm_per_rad`, `mm_per_s2`, `per_s`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace servomill::sim::config {

/// Exponents of the base units. The radian counts as a base unit, so that an angle is no number and
/// a torque per angle no torque.
struct Quantity {
  std::int8_t m = 0, kg = 0, s = 0, A = 0, K = 0, rad = 0;
  bool operator==(const Quantity&) const = default;
};

inline constexpr Quantity kNumber{};
inline constexpr Quantity kLength{.m = 1};
inline constexpr Quantity kTime{.s = 1};
inline constexpr Quantity kAngle{.rad = 1};
inline constexpr Quantity kMass{.kg = 1};
inline constexpr Quantity kCurrent{.A = 1};
inline constexpr Quantity kTemperature{.K = 1};
inline constexpr Quantity kRate{.s = -1};  // gains such as Kv, frequencies
inline constexpr Quantity kVelocity{.m = 1, .s = -1};
inline constexpr Quantity kAcceleration{.m = 1, .s = -2};
inline constexpr Quantity kJerk{.m = 1, .s = -3};
inline constexpr Quantity kAngularVelocity{.s = -1, .rad = 1};
inline constexpr Quantity kAngularAcceleration{.s = -2, .rad = 1};
inline constexpr Quantity kAngularJerk{.s = -3, .rad = 1};
inline constexpr Quantity kInertia{.m = 2, .kg = 1};
inline constexpr Quantity kForce{.m = 1, .kg = 1, .s = -2};
inline constexpr Quantity kTorque{.m = 2, .kg = 1, .s = -2};
inline constexpr Quantity kVoltage{.m = 2, .kg = 1, .s = -3, .A = -1};
inline constexpr Quantity kStiffness{.kg = 1, .s = -2};                              // N/m
inline constexpr Quantity kDamping{.kg = 1, .s = -1};                                // N s/m
inline constexpr Quantity kTorsionalStiffness{.m = 2, .kg = 1, .s = -2, .rad = -1};  // Nm/rad
inline constexpr Quantity kTorsionalDamping{.m = 2, .kg = 1, .s = -1, .rad = -1};    // Nms/rad
inline constexpr Quantity kTorqueConstant{.m = 2, .kg = 1, .s = -2, .A = -1};        // Nm/A
inline constexpr Quantity kBackEmf{.m = 2, .kg = 1, .s = -2, .A = -1, .rad = -1};    // V s/rad
inline constexpr Quantity kInductance{.m = 2, .kg = 1, .s = -2, .A = -2};            // H
inline constexpr Quantity kResistance{.m = 2, .kg = 1, .s = -3, .A = -2};            // ohm
inline constexpr Quantity kForceConstant{.m = 1, .kg = 1, .s = -2, .A = -1};         // N/A
inline constexpr Quantity kTransmission{.m = 1, .rad = -1};                          // m/rad
inline constexpr Quantity kAnglePerLength{.m = -1, .rad = 1};                        // rad/m
inline constexpr Quantity kCurrentPerAngularVelocity{.s = 1, .A = 1, .rad = -1};     // A s/rad
inline constexpr Quantity kExpansion{.K = -1};                                       // 1/K
inline constexpr Quantity kPressure{.m = -1, .kg = 1, .s = -2};                      // N/m^2
inline constexpr Quantity kPerLength{.m = -1};                                       // 1/m

/// A unit as written, with its factor to SI.
struct Unit {
  std::string symbol;
  Quantity quantity;
  double factor = 1.0;  // SI = value * factor
};

/// Reading of a text: a unit, or the reason why it is none ("unknown unit 'mmm'; did you mean
/// 'mm'?").
struct ParsedUnit {
  std::optional<Unit> unit;
  std::string complaint;
};

ParsedUnit parse_unit(std::string_view symbol);

/// The unit that the end of a key names, of this quantity: "max_rate_mm_per_s" as a velocity gives
/// mm/s, "Kv" as a rate none. The longest such ending counts.
std::optional<Unit> unit_of_key(std::string_view key, Quantity quantity);

/// A text such as "3.6 m/min/mm" in SI, or why it is none.
struct ScaledText {
  double si = 0.0;
  Unit unit;
  std::string complaint;  // "has no unit; must be a length such as "3 mm""
};

ScaledText scale_text(std::string_view text, Quantity quantity);

/// SI spelling: "m/s^2", "kg m^2/s^2/rad" or, where it has one, the usual name: "Nm/rad".
std::string si_unit(Quantity quantity);

/// Name of the quantity in messages: "a length", "a torque", or "a quantity in kg/A".
std::string name_of(Quantity quantity);

/// A unit that a writer may use, such as "mm" for a length; empty for a number.
std::string example_unit(Quantity quantity);

/// "0.3 um": an SI value in a unit of the table, with up to six digits.
/// @pre parse_unit(symbol) succeeds
std::string in_unit(double si, std::string_view symbol);

}  // namespace servomill::sim::config

/// Cutting coefficients of materials: what a millimetre of edge needs for a chip.
#pragma once

#include <array>
#include <span>
#include <string_view>

namespace servomill::plant {

/// Specific cutting forces: along the cutting speed (t), normal to the envelope of the cutter (r)
/// and along the edge's profile (a); those that grow with the chip (c) and those of the edge (e).
/// Source: Y. Altintas, Manufacturing Automation, 2nd ed., 2012, section 2.8.
struct CuttingCoefficients {
  double Ktc = 0.0, Krc = 0.0, Kac = 0.0;  // N/m^2
  double Kte = 0.0, Kre = 0.0, Kae = 0.0;  // N/m
  bool operator==(const CuttingCoefficients&) const = default;
};

/// A material with what is plausible for it, from workpiece to workpiece and edge to edge.
struct Material {
  std::string_view name;
  CuttingCoefficients typical, low, high;
  std::string_view source;
};

/// All materials, sorted by name.
std::span<const Material> materials();

/// The material of that name, or nullptr.
const Material* find_material(std::string_view name);

/// The coefficients by name, as the user writes them.
struct NamedCoefficient {
  std::string_view name;
  double CuttingCoefficients::*member;
  bool is_of_edge;  // N/m, else N/m^2
};
inline constexpr std::array<NamedCoefficient, 6> kCuttingCoefficients = {{
    {"Ktc", &CuttingCoefficients::Ktc, false},
    {"Krc", &CuttingCoefficients::Krc, false},
    {"Kac", &CuttingCoefficients::Kac, false},
    {"Kte", &CuttingCoefficients::Kte, true},
    {"Kre", &CuttingCoefficients::Kre, true},
    {"Kae", &CuttingCoefficients::Kae, true},
}};

}  // namespace servomill::plant

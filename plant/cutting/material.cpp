#include "plant/cutting/material.h"

#include <algorithm>

namespace servomill::plant {
namespace {

constexpr double N_per_mm2 = 1e6, N_per_mm = 1e3;

constexpr CuttingCoefficients coefficients(double Ktc, double Krc, double Kac, double Kte,
                                           double Kre, double Kae) {
  return {Ktc * N_per_mm2, Krc * N_per_mm2, Kac * N_per_mm2,
          Kte * N_per_mm,  Kre * N_per_mm,  Kae * N_per_mm};
}

constexpr std::array<Material, 1> kMaterials = {{
    {"42CrMo4", coefficients(2300.0, 900.0, 400.0, 40.0, 50.0, 5.0),
     coefficients(1900.0, 500.0, 150.0, 20.0, 30.0, 0.0),
     coefficients(3000.0, 1500.0, 700.0, 70.0, 90.0, 20.0),
     "quenched and tempered, carbide end mill: estimates within published ranges"},
}};

}  // namespace

std::span<const Material> materials() { return kMaterials; }

const Material* find_material(std::string_view name) {
  const auto found = std::find_if(kMaterials.begin(), kMaterials.end(),
                                  [&](const Material& one) { return one.name == name; });
  return found == kMaterials.end() ? nullptr : &*found;
}

}  // namespace servomill::plant

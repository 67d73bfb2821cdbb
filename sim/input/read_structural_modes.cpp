#include "sim/input/read_structural_modes.h"

#include "sim/input/read_inertial_deflection.h"
#include "sim/input/read_vector.h"

namespace servomill::sim::input {
namespace {

// Lengths whose square is a number.
constexpr double kShortest = 1e-100, kLongest = 1e100;

}  // namespace

std::vector<plant::StructuralMode> read_structural_modes(config::Reader& machine_table,
                                                         double step) {
  std::vector<plant::StructuralMode> out;
  for (config::Reader& table : machine_table.tables_or_none("structural_mode")) {
    plant::StructuralMode one;
    const std::size_t before = table.faults();
    const Eigen::Vector3d direction = read_vector(table, "direction", config::kNumber);
    if (table.faults() == before &&
        !(direction.norm() >= kShortest && direction.norm() <= kLongest)) {
      table.fault("direction", "must be [x, y, z], not all 0; the length is irrelevant");
    }
    const double stiffness = table.real("stiffness", config::kStiffness, {config::above(0.0)});
    read_mode(table, step, "base period", one.mode);
    if (table.faults() > before) continue;
    one.direction = direction.normalized();
    one.compliance = 1.0 / stiffness;
    out.push_back(one);
  }
  return out;
}

}  // namespace servomill::sim::input

#include "sim/input/read_cutting.h"

#include <fmt/format.h>

#include <utility>

namespace servomill::sim {
namespace {

Eigen::Vector3d read_point(Reader& table, std::string_view key) {
  const std::size_t before = table.faults();
  const auto p = table.reals(key, kLength);
  if (table.faults() > before) return Eigen::Vector3d::Zero();
  if (p.size() == 3) return Eigen::Vector3d(p.data());
  table.fault(key, "must be [x, y, z]");
  return Eigen::Vector3d::Zero();
}

plant::StockBox read_box(Reader table) {
  const std::size_t before = table.faults();
  plant::StockBox box{read_point(table, "from_mm"), read_point(table, "to_mm"),
                      table.real_or("rotation_deg", 0.0, kAngle)};
  if (table.faults() == before && !(box.from.array() < box.to.array()).all()) {
    table.fault("to_mm", "must be above from_mm in X, Y and Z");
  }
  return box;
}

plant::StockCylinder read_cylinder(Reader table) {
  const std::size_t before = table.faults();
  const auto centre = table.reals("centre_mm", kLength);
  plant::StockCylinder cylinder;
  cylinder.radius = table.real("radius_mm", kLength, {above(0.0)});
  cylinder.from = table.real("from_mm", kLength);
  cylinder.to = table.real("to_mm", kLength);
  if (table.faults() > before) return cylinder;
  if (centre.size() == 2) {
    cylinder.centre = Eigen::Vector2d(centre.data());
  } else {
    table.fault("centre_mm", "must be [x, y]");
  }
  if (!(cylinder.from < cylinder.to)) table.fault("to_mm", "must be above from_mm");
  return cylinder;
}

// Without a material the coefficients have no defaults.
plant::CuttingCoefficients read_material(Reader& table) {
  std::vector<std::string_view> names;
  for (const plant::Material& one : plant::materials()) names.push_back(one.name);
  const std::size_t before = table.faults();
  const std::size_t index = table.choice("material", names);
  if (table.faults() > before) return {};
  return plant::materials()[index].typical;
}

}  // namespace

plant::Stock read_stock(Reader& part) {
  std::vector<plant::StockSolid> solids;
  for (Reader& solid : part.tables_or_none("stock")) {
    const bool is_box = solid.has("box"), is_cylinder = solid.has("cylinder");
    if (is_box) solids.emplace_back(read_box(solid.table("box")));
    if (is_cylinder) solids.emplace_back(read_cylinder(solid.table("cylinder")));
    if (is_box != is_cylinder) continue;
    if (solid.has("stl")) {
      solid.fault("stl", "a raw part is made of boxes and cylinders; the nominal part is part.stl");
      solid.skip_rest();
    } else {
      solid.fault("must have a table 'box' or a table 'cylinder'");
    }
  }
  return plant::Stock(std::move(solids));
}

CuttingSpec read_cutting(Reader& table) {
  CuttingSpec spec;
  const bool has_material = table.has("material");
  if (has_material) spec.coefficients = read_material(table);
  for (const plant::NamedCoefficient& K : plant::kCuttingCoefficients) {
    const Quantity quantity = K.is_of_edge ? kStiffness : kPressure;
    double& to = spec.coefficients.*K.member;
    to = has_material ? table.real_or(K.name, to, quantity, {at_least(0.0)})
                      : table.real(K.name, quantity, {at_least(0.0)});
  }
  spec.wear.initial = table.real_or("wear", 1.0, kNumber, {at_least(0.0)});
  spec.wear.per_m = table.real_or("wear_per_m", 0.0, kPerLength, {at_least(0.0)});
  return spec;
}

void read_case_cutting(Reader& table, const std::optional<CuttingSpec>& common, CaseSpec& spec) {
  spec.cutting = table.boolean_or("cutting", common.has_value());
  if (common) spec.wear = common->wear;
  spec.wear.initial = table.real_or("wear", spec.wear.initial, kNumber, {at_least(0.0)});
  if (spec.cutting && !common) {
    table.fault("cutting", "needs a table [cutting] of the scenario");
    spec.cutting = false;
  } else if (table.has("wear") && !spec.cutting) {
    table.fault("wear", "has no effect: the case runs in air");
  }
}

}  // namespace servomill::sim

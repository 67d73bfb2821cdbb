#include "sim/input/read_cutting.h"

#include <fmt/format.h>

#include <utility>

#include "plant/cutting/material.h"
#include "sim/input/read_vector.h"
#include "sim/model/scenario.h"

namespace servomill::sim::input {
namespace {

Eigen::Vector3d read_point(config::Reader& table, std::string_view key) {
  return read_vector(table, key, config::kLength);
}

plant::StockBox read_box(config::Reader table) {
  const std::size_t before = table.faults();
  plant::StockBox box{read_point(table, "from_mm"), read_point(table, "to_mm"),
                      table.real_or("rotation_deg", 0.0, config::kAngle)};
  if (table.faults() == before && !(box.from.array() < box.to.array()).all()) {
    table.fault("to_mm", "must be above from_mm in X, Y and Z");
  }
  return box;
}

plant::StockCylinder read_cylinder(config::Reader table) {
  const std::size_t before = table.faults();
  const auto centre = table.reals("centre_mm", config::kLength);
  plant::StockCylinder cylinder;
  cylinder.radius = table.real("radius_mm", config::kLength, {config::above(0.0)});
  cylinder.from = table.real("from_mm", config::kLength);
  cylinder.to = table.real("to_mm", config::kLength);
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
plant::CuttingCoefficients read_material(config::Reader& table) {
  std::vector<std::string_view> names;
  for (const plant::Material& one : plant::materials()) names.push_back(one.name);
  const std::size_t before = table.faults();
  const std::size_t index = table.choice("material", names);
  if (table.faults() > before) return {};
  return plant::materials()[index].typical;
}

void read_force(config::Reader& table, model::CuttingSpec& spec) {
  constexpr std::string_view kDepths[] = {"nominal", "actual"};
  spec.actual_depth = table.choice_or("depth_of_cut", 0, kDepths) == 1;
  constexpr std::string_view kForces[] = {"average", "instantaneous"};
  spec.teeth = table.choice_or("force", 0, kForces) == 1;
  spec.regeneration = table.boolean_or("regeneration", false);
  if (spec.regeneration && !spec.teeth) {
    table.fault("regeneration", "needs force = \"instantaneous\"");
  } else if (spec.regeneration && spec.actual_depth) {
    table.fault("regeneration",
                "needs depth_of_cut = \"nominal\": the chip thickness follows the vibration");
  }
  if (!spec.teeth && table.has("steps_per_tooth")) {
    table.raw("steps_per_tooth");
    table.fault("steps_per_tooth", "needs force = \"instantaneous\"");
    return;
  }
  spec.steps_per_tooth = static_cast<int>(table.integer_or(
      "steps_per_tooth", spec.steps_per_tooth, {config::at_least(4), config::at_most(1000)}));
}

}  // namespace

plant::Stock read_stock(config::Reader& part) {
  std::vector<plant::StockSolid> solids;
  for (config::Reader& solid : part.tables_or_none("stock")) {
    const bool is_box = solid.has("box"), is_cylinder = solid.has("cylinder");
    if (is_box) solids.emplace_back(read_box(solid.table("box")));
    if (is_cylinder) solids.emplace_back(read_cylinder(solid.table("cylinder")));
    if (is_box != is_cylinder) continue;
    if (solid.has("stl")) {
      solid.fault("stl", "stock consists of boxes and cylinders; the nominal part is part.stl");
      solid.skip_rest();
    } else {
      solid.fault("must have a table 'box' or a table 'cylinder'");
    }
  }
  return plant::Stock(std::move(solids));
}

model::CuttingSpec read_cutting(config::Reader& table) {
  model::CuttingSpec spec;
  const bool has_material = table.has("material");
  if (has_material) spec.coefficients = read_material(table);
  for (const plant::NamedCoefficient& K : plant::kCuttingCoefficients) {
    const config::Quantity quantity = K.is_of_edge ? config::kStiffness : config::kPressure;
    double& to = spec.coefficients.*K.member;
    to = has_material ? table.real_or(K.name, to, quantity, {config::at_least(0.0)})
                      : table.real(K.name, quantity, {config::at_least(0.0)});
  }
  spec.wear.initial = table.real_or("wear", 1.0, config::kNumber, {config::at_least(0.0)});
  read_force(table, spec);
  spec.wear.per_m = table.real_or("wear_per_m", 0.0, config::kPerLength, {config::at_least(0.0)});
  return spec;
}

void read_case_cutting(config::Reader& table, const std::optional<model::CuttingSpec>& common,
                       model::CaseSpec& spec) {
  spec.cutting = table.boolean_or("cutting", common.has_value());
  if (common) spec.wear = common->wear;
  spec.wear.initial =
      table.real_or("wear", spec.wear.initial, config::kNumber, {config::at_least(0.0)});
  if (spec.cutting && !common) {
    table.fault("cutting", "needs the table [cutting]");
    spec.cutting = false;
  } else if (table.has("wear") && !spec.cutting) {
    table.fault("wear", "has no effect: the case runs in air");
  }
}

}  // namespace servomill::sim::input

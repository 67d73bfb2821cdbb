#include "sim/input/read_touch_probe.h"

#include <array>
#include <string_view>

#include "plant/vocabulary/units.h"
#include "sim/input/read_vector.h"

namespace servomill::sim::input {
namespace {

using Eigen::Vector3d;

constexpr double kMaxSeed = 9007199254740992.0;  // 2^53: whole numbers are exact up to there
constexpr double kMaxLobes = 12;
constexpr std::array<std::string_view, 3> kWorkpieces = {"stock", "part", "none"};
constexpr std::array<std::string_view, 2> kLengths = {"centre", "end"};

Vector3d read_vector_or_zero(config::Reader& table, std::string_view key,
                             config::Quantity quantity) {
  return table.has(key) ? read_vector(table, key, quantity) : Vector3d(Vector3d::Zero());
}

double read_radius(config::Reader& table, std::string_view diameter) {
  return 0.5 * table.real(diameter, config::kLength, {config::above(0.0)});
}

metrology::SphereBody read_sphere(config::Reader& table) {
  return {read_vector(table, "centre_mm", config::kLength), read_radius(table, "diameter_mm")};
}

metrology::PlaneBody read_plane(config::Reader& table) {
  const std::size_t before = table.faults();
  metrology::PlaneBody plane{read_vector(table, "point_mm", config::kLength),
                             read_vector(table, "normal", config::kNumber)};
  if (table.faults() == before && !(plane.normal.norm() > 0.0)) {
    table.fault("normal", "must not be zero");
  }
  plane.normal.normalize();
  return plane;
}

metrology::BoreBody read_bore(config::Reader& table) {
  const std::size_t before = table.faults();
  const std::vector<double> centre = table.reals("centre_mm", config::kLength);
  metrology::BoreBody bore;
  bore.radius = read_radius(table, "diameter_mm");
  bore.from = table.real("from_mm", config::kLength);
  bore.to = table.real("to_mm", config::kLength);
  if (table.faults() > before) return bore;
  if (centre.size() == 2) {
    bore.centre = Eigen::Vector2d(centre.data());
  } else {
    table.fault("centre_mm", "must be [x, y]");
  }
  if (!(bore.from < bore.to)) table.fault("to_mm", "must be above from_mm");
  return bore;
}

void read_switching(config::Reader& table, model::TouchProbe& out) {
  const auto not_below_zero = {config::at_least(0.0)};
  out.pretravel = table.real_or("pretravel_um", 0.0, config::kLength, not_below_zero);
  out.lobing = table.real_or("lobing_um", 0.0, config::kLength, not_below_zero);
  out.lobes = static_cast<int>(
      table.integer_or("lobes", 3, {config::at_least(1), config::at_most(kMaxLobes)}));
  out.lobing_phase = table.real_or("lobing_phase_deg", 0.0, config::kAngle);
  out.repeatability = table.real_or("repeatability_um", 0.0, config::kLength, not_below_zero);
  out.delay = table.real_or("delay_us", 0.0, config::kTime, not_below_zero);
  out.seed = static_cast<std::uint64_t>(
      table.integer_or("seed", 1, {config::at_least(0), config::at_most(kMaxSeed)}));
}

void read_stylus(config::Reader& table, model::TouchProbe& out) {
  const std::size_t before = table.faults();
  out.radius = read_radius(table, "stylus_diameter_mm");
  out.stylus = read_vector_or_zero(table, "stylus_offset_um", config::kLength);
  const bool is_to_end =
      table.has("tool_length_to") && table.choice("tool_length_to", kLengths) == 1;
  if (table.faults() == before && is_to_end) out.stylus.z() += out.radius;
}

// The workpiece lies elsewhere than the program takes it to be.
Eigen::Isometry3d read_place_of_workpiece(config::Reader& table) {
  const Vector3d shift = read_vector_or_zero(table, "workpiece_shift_mm", config::kLength);
  const Vector3d turn = read_vector_or_zero(table, "workpiece_rotation_deg", config::kAngle);
  const double angle = turn.norm();
  const Eigen::AngleAxisd rotation(
      angle, angle > 0.0 ? Vector3d(turn / angle) : Vector3d(Vector3d::UnitZ()));
  return Eigen::Translation3d(shift) * rotation;
}

void add_workpiece(config::Reader& table, const plant::Stock& stock,
                   const std::shared_ptr<const evaluation::NominalPart>& part,
                   model::TouchProbe& out) {
  const Eigen::Isometry3d motion = read_place_of_workpiece(table);
  const std::size_t fallback = !stock.empty() ? 0 : part ? 1 : 2;
  const std::size_t before = table.faults();
  const std::size_t chosen =
      table.has("workpiece") ? table.choice("workpiece", kWorkpieces) : fallback;
  if (table.faults() > before) return;
  if (chosen == 0 && stock.empty()) table.fault("workpiece", "needs a [[part.stock]]");
  if (chosen == 1 && !part) table.fault("workpiece", "needs part.stl");
  if (chosen == 0) {
    for (const plant::StockSolid& solid : stock.solids()) {
      out.bodies.emplace_back(metrology::DisplacedBody{solid, motion});
    }
  } else if (chosen == 1 && part) {
    out.bodies.emplace_back(metrology::DisplacedBody{part->mesh, motion});
  } else {
    for (const char* const key : {"workpiece_shift_mm", "workpiece_rotation_deg"}) {
      if (table.has(key)) table.fault(key, "has no effect: the probe meets no workpiece");
    }
  }
}

}  // namespace

std::shared_ptr<const model::TouchProbe> read_touch_probe(
    config::Reader& root, const plant::Stock& stock,
    const std::shared_ptr<const evaluation::NominalPart>& part) {
  if (!root.has("touch_probe")) return nullptr;
  config::Reader table = root.table("touch_probe");
  model::TouchProbe out;
  out.place = root.place("touch_probe");
  read_stylus(table, out);
  read_switching(table, out);
  for (config::Reader& one : table.tables_or_none("sphere"))
    out.bodies.emplace_back(read_sphere(one));
  for (config::Reader& one : table.tables_or_none("plane"))
    out.bodies.emplace_back(read_plane(one));
  for (config::Reader& one : table.tables_or_none("bore")) out.bodies.emplace_back(read_bore(one));
  const std::size_t before = table.faults();
  add_workpiece(table, stock, part, out);
  if (table.faults() == before && out.bodies.empty()) {
    table.fault(
        "has no object to probe: add a [[touch_probe.sphere]], plane or bore, a [[part.stock]] or "
        "part.stl");
  }
  return std::make_shared<const model::TouchProbe>(std::move(out));
}

}  // namespace servomill::sim::input

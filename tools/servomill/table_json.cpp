#include "tools/servomill/table_json.h"

#include <limits>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/system/json.h"
#include "sim/tables/table_export.h"
#include "sim/tables/verify_tables.h"

namespace servomill::tools {
namespace {

using sim::system::JsonObject;
using sim::tables::TableExport;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

const char* unit_of(bool is_angle) { return is_angle ? "urad" : "um"; }

std::string table_json(const TableExport& e, const sim::tables::CompensationTable& table) {
  const bool linear = table.line.joint < kLinearJoints;
  const double position = linear ? mm : deg;
  return JsonObject()
      .text("over", std::string(1, e.letter(table.line.joint)))
      .text_or_null("error", table.component ? plant::to_string(*table.component) : "")
      .text_or_null("axis", table.component ? "" : std::string(1, e.letter(table.output)))
      .integer("points", table.line.points)
      .text("position_unit", linear ? "mm" : "deg")
      .number("first", table.line.first / position)
      .number("spacing", table.line.spacing / position)
      .boolean("depends_on_direction", table.depends_on_direction())
      .text("unit", unit_of(table.is_angle()))
      .number("largest", table.largest() / um)
      .number("uncertainty", table.uncertainty.value_or(kUnknown) / um)
      .number("residual", table.residual / um)
      .line();
}

std::string grid_json(const sim::tables::GridTable& grid) {
  std::vector<std::string> axes, points;
  for (std::size_t k = 0; k < grid.points.axes.size(); ++k) {
    axes.emplace_back(1, letter(grid.points.axes[k]));
    points.push_back(std::to_string(grid.points.at[k].size()));
  }
  return JsonObject()
      .text("error", plant::to_string(grid.name))
      .raw("over", sim::system::json_texts(axes))
      .raw("points", sim::system::json_list(points))
      .text("unit", unit_of(grid.is_angle()))
      .number("largest", grid.largest() / um)
      .number("residual", grid.residual / um)
      .line();
}

std::string left_json(const sim::tables::TableResidual& one) {
  return JsonObject()
      .text("error", plant::to_string(one.name))
      .text("unit", unit_of(!is_linear(one.name.direction)))
      .number("largest", one.size / um)
      .number("tip_um", one.tip / um)
      .number("tool_axis_urad", one.tool_axis / urad)
      .line();
}

// Commands x -= a y + b z, y -= c z.
std::string skew_json(const sim::tables::SkewSettings& skew) {
  const Eigen::Vector3d U = skew.uncertainty.value_or(Eigen::Vector3d::Constant(kUnknown));
  std::vector<std::string> left_out;
  for (const auto& one : skew.left_out) left_out.push_back(plant::to_string(one.squareness[0]));
  return JsonObject()
      .number("a_urad", skew.a / urad)
      .number("b_urad", skew.b / urad)
      .number("c_urad", skew.c / urad)
      .number("uncertainty_a_urad", U[0] / urad)
      .number("uncertainty_b_urad", U[1] / urad)
      .number("uncertainty_c_urad", U[2] / urad)
      .raw("left_out", sim::system::json_texts(left_out))
      .line();
}

std::string mesh_json(const sim::tables::BedMesh& mesh) {
  return JsonObject()
      .integer("points_X", mesh.nx)
      .integer("points_Y", mesh.ny)
      .number("X_from_mm", mesh.range[0] / mm)
      .number("X_to_mm", mesh.range[1] / mm)
      .number("Y_from_mm", mesh.range[2] / mm)
      .number("Y_to_mm", mesh.range[3] / mm)
      .number("Z_before_um", mesh.before / um)
      .number("Z_after_um", mesh.after / um)
      .number("uncertainty_um", mesh.uncertainty.value_or(kUnknown) / um)
      .line();
}

// The notes of the report, without what the other members hold.
std::vector<std::string> notes_of(const TableExport& e) {
  constexpr std::string_view kNote = "note: ";
  std::vector<std::string> out;
  for (const std::string& line : sim::tables::report(e)) {
    if (line.starts_with(kNote)) out.push_back(line.substr(kNote.size()));
  }
  return out;
}

// Largest displacement of the tip; formats that hold the errors themselves have none.
sim::tables::Volume volume_of(const TableExport& e) {
  if (e.rules().components) return {kUnknown, kUnknown};
  return e.skew ? e.skew->volume : e.volume;
}

template <class Items, class Json>
std::string list_of(const Items& items, const Json& json) {
  std::vector<std::string> out;
  for (const auto& one : items) out.push_back(json(one));
  return sim::system::json_list(out);
}

}  // namespace

std::string tables_json(const TableExport& e, const sim::tables::TableVerification& verified,
                        const std::vector<std::string>& files) {
  const sim::tables::Volume volume = volume_of(e);
  return JsonObject()
      .text("format", sim::tables::name_of(e.request.format))
      .text("machine", e.machine)
      .text("model", e.request.model)
      .text("document", e.rules().document)
      .raw("tables", list_of(e.tables, [&](const auto& one) { return table_json(e, one); }))
      .raw("grids", list_of(e.grids, grid_json))
      .raw("skew", e.skew ? skew_json(*e.skew) : "null")
      .raw("mesh", e.mesh ? mesh_json(*e.mesh) : "null")
      .raw("left", list_of(e.left, left_json))
      .number("tip_before_um", volume.before / um)
      .number("tip_after_um", volume.after / um)
      .raw("verified", JsonObject()
                           .integer("positions", verified.positions)
                           .number("largest_um", verified.length / um)
                           .number("largest_urad", verified.angle / urad)
                           .line())
      .raw("notes", sim::system::json_texts(notes_of(e)))
      .raw("files", sim::system::json_texts(files))
      .line();
}

}  // namespace servomill::tools

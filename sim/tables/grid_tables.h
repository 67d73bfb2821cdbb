/// Tables of component errors over the positions of several axes.
#pragma once

#include <optional>
#include <vector>

#include "plant/geometry/grid_function.h"
#include "sim/tables/compensation_tables.h"

namespace servomill::sim::tables {

/// One component error on a grid, as a control takes it: multilinear between the points.
struct GridTable {
  plant::ErrorName name;
  plant::GridPoints points;  // rounded as written; the axis of the error last
  double residual = 0.0;     // m, rad: largest that interpolation and rounding leave

  bool is_angle() const { return !is_linear(name.direction); }
  double largest() const;  ///< magnitude, over the points
};

/// True if errors of this name go into a grid: they depend on other axes than their own, or are
/// converted together with others that do (tool_side_errors.h).
bool needs_grid(const TableSource& source, const FormatRules& rules, const plant::ErrorName& name);

/// Grids of all errors that need one, over axes for which a table is wanted. Positions are those of
/// the errors' own grids within the travel, more of them where the errors are not linear in
/// between.
/// @throws InputError if the format takes functions of one axis only, or a grid is too large
std::vector<GridTable> grid_tables_of(const TableSource& source,
                                      const std::vector<TableLine>& lines,
                                      const FormatRules& rules);

/// Positions of axes all over the travel, evenly spread, always the same.
/// @param n  1, 2, ...
/// @return joints (5; m, rad), the others at the reference
Joints spread_pose(const TableSource& source, const std::vector<TableLine>& lines, int n);

/// Component error of an axis that counts as carrying the tool (rules.tool_side), or as ours.
/// @param q  coordinates of all axes (6; m, rad)
double written_error(const TableSource& source, const FormatRules& rules,
                     const plant::ErrorName& name, const AxisWords& q);

}  // namespace servomill::sim::tables

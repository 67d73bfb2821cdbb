/// Errors that compensation tables over single axes cannot correct. A shift of the machine's zero
/// does not count: the error at the reference position is subtracted everywhere.
#pragma once

#include <optional>
#include <vector>

#include "sim/tables/compensation_tables.h"

namespace servomill::sim::tables {

/// One error that tables leave in part or as a whole. Interpolation is not counted here.
struct TableResidual {
  plant::ErrorName name;
  double size = 0.0;       // m, rad: its largest magnitude within the travel
  double tip = 0.0;        // m: largest displacement of the tip that stays, were it alone
  double tool_axis = 0.0;  // rad: largest tilt of the tool that stays
};

/// Largest displacement of the tip at poses spread over the travel, all errors together.
struct Volume {
  double before = 0.0;  // m
  double after = 0.0;   // m, with the tables as they are written
};

/// A table that is not written: displacement of axis `output` over axis `base`.
struct OmittedTable {
  int base = 0, output = 0;
  double largest = 0.0;  // m, rad
  /// Expanded (k = 2; m, rad) of a table that is not determined; none: of second order.
  std::optional<double> uncertainty = std::nullopt;
};

/// Errors of which more stays than kNothing, in the order X, Y, Z, A, B, C of their axes, component
/// errors before location errors.
/// @param lines    one for each axis of the machine: its travel, and whether it has tables
/// @param omitted  tables that the format could hold
std::vector<TableResidual> table_residuals(const TableSource& source,
                                           const std::vector<TableLine>& lines,
                                           const std::vector<OmittedTable>& omitted,
                                           const FormatRules& rules);

Volume volume(const TableSource& source, const std::vector<TableLine>& lines,
              const std::vector<CompensationTable>& tables);

inline constexpr double kNothing = 1e-9;  // m, rad

}  // namespace servomill::sim::tables

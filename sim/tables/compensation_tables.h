/// Compensation tables: values at equidistant points of one axis, linear between them.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "plant/geometry/error_model.h"
#include "sim/tables/line_correction.h"
#include "sim/tables/table_format.h"

namespace servomill::sim::tables {

/// The positions of one axis over which tables run.
struct TableLine {
  int joint = 0;
  double from = 0.0, to = 0.0;  // m, rad: the travel that must be covered
  double first = 0.0;           // m, rad: of the first point
  double spacing = 1.0;         // m, rad
  std::size_t points = 2;
  bool one_turn = false;  // runs from 0 to 360 deg: entries beyond the travel stand for angles < 0
  bool wraps = false;     // repeats every 360 deg
  bool wanted = true;     // whether tables are made over it

  double entry(std::size_t i) const { return first + static_cast<double>(i) * spacing; }
  /// Position of the axis for which an entry stands.
  double position(double entry) const;
  double entry_of(double position) const;  ///< the way back
};

/// Request for the line of one axis; the rest follows from the format.
struct LineRequest {
  int joint = 0;
  char letter = 'X';
  std::optional<double> lower, upper;  // m, rad: travel; absent for an endless rotary axis
  std::optional<double> spacing;       // m, rad; absent: the smallest of a round series that fits
  std::size_t most_points = 256;
  bool wanted = true;
};

/// @throws InputError if the points are too many (with the smallest spacing that fits), or a linear
///         axis has no travel
TableLine make_line(const LineRequest& request, const FormatRules& rules);

/// The next smaller spacing of the round series; none: it has too many points.
/// @param most_points  of a table
std::optional<TableLine> finer_line(TableLine line, const FormatRules& rules,
                                    std::size_t most_points);

/// One column of one table.
struct CompensationTable {
  TableLine line;
  int output = 0;                             // joint that is corrected
  std::optional<plant::ErrorName> component;  // set where one error is tabulated, not an axis
  std::vector<double> error;                  // m, rad: actual minus nominal, rounded as written
  std::vector<double> error_down;  // travelling down; empty: as `error`, which then is the mean
  bool is_second_order = false;    // see kSecondOrder

  bool is_angle() const;
  bool depends_on_direction() const { return !error_down.empty(); }
  /// Linear between points, constant beyond them.
  /// @param direction  of travel: 1 up, -1 down
  double at(double entry, int direction = 1) const;
  double largest() const;  ///< magnitude, over the points
  /// Largest expanded uncertainty (k = 2) of its values (m, rad); none: not known.
  std::optional<double> uncertainty;
  double residual = 0.0;    // m, rad: largest that linear interpolation and rounding leave
  double steepest() const;  ///< largest magnitude of step over spacing
};

/// The displacement of an axis to which no error contributes in first order is not worth a table up
/// to this size: an axis inclined by EC0Y = 200 urad is shorter along Y by 0.012 um in 0.6 m.
inline constexpr double kSecondOrder = 0.1e-6;  // m, rad

/// Tables of the displacements on the lines, 0 at the reference; none for those that would hold
/// zeros only. Those of second order up to kSecondOrder are marked.
std::vector<CompensationTable> tables_of(const TableSource& source,
                                         const std::vector<TableLine>& lines,
                                         const FormatRules& rules);

/// Tables of the component errors themselves, by their names.
std::vector<CompensationTable> component_tables_of(const TableSource& source,
                                                   const std::vector<TableLine>& lines,
                                                   const FormatRules& rules);

}  // namespace servomill::sim::tables

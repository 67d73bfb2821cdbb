#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "controllers/tables/csv_table.h"
#include "controllers/tables/etalon_table.h"
#include "controllers/tables/isg_table.h"
#include "plant/geometry/travelling_errors.h"
#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/tables/table_comparison.h"
#include "sim/tables/tool_side_poses.h"

namespace servomill::sim::tables {
namespace {

using controllers::ControlTable;

constexpr int kGridPoses = 1000;

controllers::ErrorColumns read(const TableExport& e, const std::vector<TextFile>& files) {
  const auto texts = texts_of(files);
  switch (e.request.format) {
    case TableFormat::isg:
      return controllers::read_isg_table(texts.front());
    case TableFormat::etalon:
      return controllers::read_etalon_table(texts.front());
    default:
      return controllers::read_csv_tables(texts);
  }
}

// The errors themselves, by their names.
class Columns {
 public:
  Columns(const TableExport& e, const std::vector<TextFile>& files)
      : e_(e),
        file_(files.empty() ? "" : files.front().name),
        columns_(read(e, files)),
        check_(e) {}

  TableVerification run() {
    check_names();
    for (const TableLine& line : e_.lines) {
      const Axis axis = axis_at(e_, line.joint);
      for (const Axis direction : kAllAxes) {
        if (line.wanted) check_component(line, {direction, axis, false});
        check_location({direction, axis, true});
      }
    }
    for (const GridTable& table : e_.grids) check_grid(table);
    return check_.result();
  }

 private:
  // Columns of axes that have no table.
  void check_names() const {
    for (const controllers::ErrorColumn& one : columns_.components) {
      const bool is_wanted = std::any_of(e_.lines.begin(), e_.lines.end(), [&](const auto& line) {
        return line.wanted && axis_at(e_, line.joint) == one.base_axis;
      });
      if (is_wanted) continue;
      throw InputError({one.file, one.points.front().line},
                       fmt::format("verification failed: {} is unexpected", one.name));
    }
    for (const controllers::ErrorGrid& one : columns_.grids) {
      if (std::any_of(e_.grids.begin(), e_.grids.end(),
                      [&](const GridTable& table) { return to_string(table.name) == one.name; })) {
        continue;
      }
      throw InputError(
          {one.file, one.line},
          fmt::format("verification failed: {} over several axes is unexpected", one.name));
    }
  }

  // Errors over several axes: those of the machine with errors while its other axes are held.
  void check_grid(const GridTable& table) {
    const auto grid =
        std::find_if(columns_.grids.begin(), columns_.grids.end(),
                     [&](const auto& one) { return one.name == to_string(table.name); });
    if (grid == columns_.grids.end()) {
      throw InputError({file_},
                       fmt::format("verification failed: {} is missing", to_string(table.name)));
    }
    if (grid->axes != table.points.axes) {
      throw InputError({grid->file, grid->line},
                       fmt::format("verification failed: {} has other arguments", grid->name));
    }
    const double digit = table.is_angle() ? e_.rules().angle_step : e_.rules().length_step;
    const plant::ErrorModel errors = errors_of(table.name.axis);
    check_grid_points(table, *grid, errors, digit);
    std::vector<double> position(grid->axes.size());
    for (int n = 1; n <= kGridPoses; ++n) {
      const AxisWords q = e_.source.chain.layout.words(spread_pose(e_.source, e_.lines, n));
      for (std::size_t k = 0; k < position.size(); ++k) position[k] = q[index_of(grid->axes[k])];
      check_grid_value(table, *grid, poses_at(table, errors, q), q, grid->value(position),
                       table.residual + digit);
    }
  }

  // On one line over its own axis, the last argument, after the other.
  void check_grid_points(const GridTable& table, const controllers::ErrorGrid& grid,
                         const plant::ErrorModel& errors, double digit) {
    AxisWords q = e_.source.chain.layout.words(e_.source.reference);
    const std::vector<double>& own = grid.at.back();
    for (std::size_t n = 0; n < grid.error.size(); n += own.size()) {
      std::size_t rest = n / own.size();
      for (std::size_t k = grid.axes.size() - 1; k-- > 0;) {
        q[index_of(grid.axes[k])] = grid.at[k][rest % grid.at[k].size()];
        rest /= grid.at[k].size();
      }
      const ToolSidePoses poses = poses_at(table, errors, q);
      for (std::size_t i = 0; i < own.size(); ++i) {
        q[index_of(table.name.axis)] = own[i];
        check_grid_value(table, grid, poses, q, grid.error[n + i], digit);
      }
    }
  }

  // The component errors of one axis alone: those that are held at every pose.
  plant::ErrorModel errors_of(Axis axis) const {
    plant::ErrorModel out;
    for (const Axis direction : kAllAxes) {
      const plant::ErrorName name{direction, axis, false};
      out.component(name) = e_.source.errors.component(name);
    }
    return out;
  }

  // Poses of the machine while all axes but that of the error are held.
  ToolSidePoses poses_at(const GridTable& table, const plant::ErrorModel& errors,
                         const AxisWords& q) const {
    return {e_.source.chain, plant::held(errors, table.name.axis, q), table.name.axis};
  }

  void check_grid_value(const GridTable& table, const controllers::ErrorGrid& grid,
                        const ToolSidePoses& poses, const AxisWords& q, double read,
                        double within) {
    const double needed = poses.value(table.name.direction, q[index_of(table.name.axis)]);
    check_.count(table.is_angle(), read - needed);
    if (std::abs(read - needed) <= within * (1.0 + kDigitSlack)) return;
    throw InputError(
        {grid.file, grid.line},
        fmt::format("verification failed: {}: the file gives {}, the error model {}", grid.name,
                    exact_size(table.is_angle(), read), exact_size(table.is_angle(), needed)));
  }

  // The column that holds an error in one direction of travel; empty points: there is none.
  ControlTable column(const TableLine& line, const plant::ErrorName& name, int direction) const {
    ControlTable out;
    for (const controllers::ErrorColumn& one : columns_.components) {
      const bool is_it = one.name == to_string(name) && one.base_axis == name.axis &&
                         one.direction * direction >= 0;
      if (!is_it) continue;
      check_.check_points(line, one.file, one.points);
      out.file = one.file;
      out.points = one.points;
    }
    return out;
  }

  void check_component(const TableLine& line, const plant::ErrorName& name) {
    if (needs_grid(e_.source, e_.rules(), name)) return;  // check_grid
    const plant::ErrorFunction& error = e_.source.errors.component(name);
    const std::array<ControlTable, 2> tables = {column(line, name, -1), column(line, name, 1)};
    if (tables[0].points.empty() && tables[1].points.empty() && error.is_zero() &&
        !e_.rules().tool_side) {
      return;
    }
    Comparison c;
    c.file = tables[1].file;
    c.title = to_string(name);
    c.is_angle = !is_linear(name.direction);
    c.digit = c.is_angle ? e_.rules().angle_step : e_.rules().length_step;
    c.needed = [&](double q, int direction) {
      return component_on_line(e_.source, name, q, direction);
    };
    if (e_.rules().tool_side) {
      const auto needed = std::make_shared<ToolSidePoses>(
          e_.source.chain,
          plant::held(e_.source.errors, name.axis,
                      e_.source.chain.layout.words(e_.source.reference)),
          name.axis);
      c.needed = [needed, name](double q, int) { return needed->value(name.direction, q); };
    }
    c.read = [&](double q, int direction) {
      const ControlTable& table = tables[direction > 0 ? 1 : 0];
      return table.points.empty() ? 0.0 : table.at(line.entry_of(q), direction);
    };
    c.line_at = [&](double q) {
      return tables[1].points.empty() ? 0 : tables[1].point_below(line.entry_of(q)).line;
    };
    check_.check(line, c);
  }

  void check_location(const plant::ErrorName& name) const {
    const double wanted = e_.source.errors.location(name);
    const auto found = columns_.locations.find(to_string(name));
    const bool is_there = found != columns_.locations.end();
    const double read = is_there ? found->second.value : 0.0;
    const bool is_angle = !is_linear(name.direction);
    const double digit = is_angle ? e_.rules().angle_step : e_.rules().length_step;
    if (std::abs(read - wanted) <= digit * (1.0 + kDigitSlack)) return;
    throw InputError(
        {location_file(), is_there ? found->second.line : 0},
        fmt::format("verification failed: {}: the file gives {}, the error model {}",
                    to_string(name), exact_size(is_angle, read), exact_size(is_angle, wanted)));
  }

  std::string location_file() const { return e_.rules().tool_side ? file_ : "locations.csv"; }

  const TableExport& e_;
  std::string file_;
  controllers::ErrorColumns columns_;
  TableComparison check_;
};

}  // namespace

TableVerification verify_columns(const TableExport& e, const std::vector<TextFile>& files) {
  return Columns(e, files).run();
}

}  // namespace servomill::sim::tables

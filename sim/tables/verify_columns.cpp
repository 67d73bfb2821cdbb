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
#include "sim/tables/table_comparison.h"
#include "sim/tables/tool_side_poses.h"

namespace servomill::sim::tables {
namespace {

using controllers::ControlTable;

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
                       fmt::format("not as verified: {} is not needed", one.name));
    }
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
      return plant::travelling(error, direction).value(q);
    };
    if (e_.rules().tool_side) {
      const auto needed =
          std::make_shared<ToolSidePoses>(e_.source.chain, e_.source.errors, name.axis);
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
        fmt::format("not as verified: {}: the file gives {}, the error model {}", to_string(name),
                    exact_size(is_angle, read), exact_size(is_angle, wanted)));
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

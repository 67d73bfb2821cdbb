#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"
#include "sim/tables/mesh_settings.h"
#include "sim/tables/skew_settings.h"
#include "sim/tables/table_uncertainty.h"
#include "sim/tables/unknown_errors.h"

namespace servomill::sim::tables {
namespace {

double unit_of(int joint) { return joint < kLinearJoints ? mm : deg; }
const char* unit_name_of(int joint) { return joint < kLinearJoints ? "mm" : "deg"; }

std::string size_of(bool angle, double value) {
  return angle ? fmt::format("{:.3f} urad", value / urad) : fmt::format("{:.3f} um", value / um);
}

std::string title_of(const TableExport& e, const CompensationTable& table) {
  const char over = e.letter(table.line.joint);
  return table.component ? fmt::format("{} over {}", to_string(*table.component), over)
                         : fmt::format("{} over {}", e.letter(table.output), over);
}

std::string line_of(const TableExport& e, const CompensationTable& table) {
  const int j = table.line.joint;
  return fmt::format(
             "  {}: {} points, {:g} {} apart from {:g} {}, up to {}; linear interpolation "
             "and rounding leave up to {}",
             title_of(e, table), table.line.points, table.line.spacing / unit_of(j),
             unit_name_of(j), table.line.first / unit_of(j), unit_name_of(j),
             size_of(table.is_angle(), table.largest()),
             size_of(table.is_angle(), table.residual)) +
         uncertainty_text(table);
}

std::string line_of(const GridTable& grid) {
  std::string axes, points;
  for (std::size_t k = 0; k < grid.points.axes.size(); ++k) {
    axes += fmt::format("{}{}", k == 0 ? "" : ", ", letter(grid.points.axes[k]));
    points += fmt::format("{}{}", k == 0 ? "" : " x ", grid.points.at[k].size());
  }
  return fmt::format(
      "  {} over {}: grid of {} points, up to {}; linear interpolation and rounding leave up to {}",
      to_string(grid.name), axes, points, size_of(grid.is_angle(), grid.largest()),
      size_of(grid.is_angle(), grid.residual));
}

std::string reference_line(const TableExport& e) {
  std::string where;
  for (const TableLine& line : e.lines) {
    const int j = line.joint;
    where += fmt::format("{}{} = {:g} {}", where.empty() ? "" : ", ", e.letter(j),
                         e.source.reference[j] / unit_of(j), unit_name_of(j));
  }
  return fmt::format(
      "reference: each table contains the errors along its axis through {}, tool {:g} mm", where,
      e.request.tool_length / mm);
}

void add_base(const TableExport& e, std::vector<std::string>& out) {
  std::string text;
  for (const TableLine& line : e.lines) {
    const double error = -e.base[line.joint];
    if (std::abs(error) <= kNothing) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", e.letter(line.joint),
                        size_of(line.joint >= kLinearJoints, error));
  }
  if (text.empty()) return;
  out.push_back(fmt::format(
      "zero: the tables are 0 at the reference; the error there is left to the work offset: {}",
      text));
}

void add_table_residuals(const TableExport& e, std::vector<std::string>& out) {
  if (e.left.empty()) {
    out.push_back("not in these tables: none");
    return;
  }
  out.push_back(
      "not in these tables, or only on their lines (largest value; its residual within the travel, "
      "relative to the reference):");
  for (const TableResidual& one : e.left) {
    std::string leaves;
    if (one.tip > kNothing) leaves = fmt::format("tip {}", size_of(false, one.tip));
    if (one.tool_axis > kNothing) {
      leaves +=
          fmt::format("{}tool axis {}", leaves.empty() ? "" : ", ", size_of(true, one.tool_axis));
    }
    out.push_back(fmt::format("  {:<5} {}; {}", to_string(one.name),
                              size_of(!is_linear(one.name.direction), one.size), leaves));
  }
}

// Is there a table that this error over the position of the axis goes into?
bool has_table(const TableExport& e, const TableLine& line, const plant::ErrorName& name) {
  const auto joint = e.source.chain.layout.joint_of(name.direction);
  return std::any_of(e.tables.begin(), e.tables.end(), [&](const CompensationTable& table) {
    if (table.line.joint != line.joint) return false;
    if (table.component) return *table.component == name;
    return !is_linear(name.direction) || (joint && table.output == *joint);
  });
}

// The directions of travel that the tables over one axis hold.
std::string directions_in(const TableExport& e, const TableLine& line) {
  std::string both, mean;
  for (const CompensationTable& table : e.tables) {
    if (table.line.joint != line.joint) continue;
    std::string& list = table.depends_on_direction() ? both : mean;
    list += fmt::format("{}{}", list.empty() ? "" : ", ", title_of(e, table));
  }
  if (both.empty()) return "the tables contain the mean";
  return "both directions are contained in " + both + (mean.empty() ? "" : "; the mean by " + mean);
}

void add_omitted(const TableExport& e, std::vector<std::string>& out) {
  for (const OmittedTable& table : e.omitted) {
    if (table.uncertainty) continue;
    out.push_back(fmt::format(
        "note: no table {} over {}: {} at most, of second order in errors of other directions",
        e.letter(table.output), e.letter(table.base),
        size_of(table.output >= kLinearJoints, table.largest)));
  }
}

// SINUMERIK 828D: eight tables of $AN_CEC, which cannot be extended (6FC5397-1BP40-3BA1, page 264).
void add_table_count(const TableExport& e, std::vector<std::string>& out) {
  constexpr int kTables = 8;
  if (e.request.format != TableFormat::siemens) return;
  int count = 0;
  for (const CompensationTable& table : e.tables) {
    const bool is_cross = table.output != table.line.joint;
    count += table.depends_on_direction() ? 2 : static_cast<int>(is_cross);
  }
  if (count <= kTables) return;
  out.push_back(
      fmt::format("note: {} tables of $AN_CEC; a SINUMERIK 828D has {}: choose axes with --axis",
                  count, kTables));
}

void note_ends_of_turns(const TableExport& e, std::vector<std::string>& out) {
  for (const CompensationTable& table : e.tables) {
    if (!table.line.one_turn || table.line.wraps || table.component) continue;
    out.push_back(
        fmt::format("note: {}: the control does not repeat the table: beyond 0 and 360 deg the end "
                    "values apply",
                    title_of(e, table)));
  }
}

void note_reversals(const TableExport& e, const TableLine& line, std::vector<std::string>& out) {
  const Axis axis = *e.source.chain.layout.axis[static_cast<std::size_t>(line.joint)];
  for (const Axis direction : kAllAxes) {
    const plant::ErrorName name{direction, axis, false};
    const plant::ErrorFunction& error = e.source.errors.component(name);
    if (error.reversals.empty()) continue;
    const double most = std::max(std::abs(error.width(line.from)), std::abs(error.width(line.to)));
    out.push_back(fmt::format(
        "note: {} depends on the direction of travel, by {} at the ends of the travel; {}",
        to_string(name), size_of(!is_linear(direction), most),
        has_table(e, line, name)
            ? directions_in(e, line)
            : fmt::format("there is no table {} over {}: half of it, {}, remains in each direction",
                          letter(direction), e.letter(line.joint),
                          size_of(!is_linear(direction), 0.5 * most))));
  }
}

// The part of an error over several axes that a format contains.
std::string part_of_grids(const TableExport& e) {
  if (e.mesh) {
    return fmt::format("the bed mesh contains it at Z = {:g} mm only, as far as it moves Z",
                       e.source.reference[2] / mm);
  }
  return e.rules().skew ? "the skew correction contains none of it"
                        : "tables over one axis contain it on the lines through the reference only";
}

// Tables over one axis hold an error over several where the others are at the reference.
void note_grids(const TableExport& e, const TableLine& line, std::vector<std::string>& out) {
  if (e.rules().components) return;
  const Axis axis = *e.source.chain.layout.axis[static_cast<std::size_t>(line.joint)];
  for (const Axis direction : kAllAxes) {
    const plant::ErrorName name{direction, axis, false};
    std::string others;
    for (const Axis a : e.source.errors.component(name).grid_axes()) {
      if (a != axis) others += fmt::format("{}{}", others.empty() ? "" : ", ", letter(a));
    }
    if (others.empty()) continue;
    out.push_back(
        fmt::format("note: {} depends on the position of {}, too; {} (isg contains all of it)",
                    to_string(name), others, part_of_grids(e)));
  }
}

void note_powers_of_two(const TableExport& e, std::vector<std::string>& out) {
  for (const TableLine& line : e.lines) {
    const double exponent = std::log2(line.spacing / kGridStep);
    if (line.joint >= kLinearJoints || !line.wanted) continue;
    if (std::abs(exponent - std::round(exponent)) < 1e-9) continue;
    out.push_back(fmt::format(
        "note: {}: controls without the column AXISPOS need a spacing of 2^n x 0.0001 mm",
        e.letter(line.joint)));
  }
  for (const CompensationTable& table : e.tables) {
    if (table.is_angle() || table.steepest() <= 1.0 / kGridSteps) continue;
    out.push_back(fmt::format(
        "note: {}: {:.3f} um/mm; tables of 64 points (code number 105 296) take at most {:g} um/mm",
        title_of(e, table), table.steepest() / (um / mm), 1.0 / kGridSteps / (um / mm)));
  }
}

void add_notes(const TableExport& e, std::vector<std::string>& out) {
  note_ends_of_turns(e, out);
  for (const TableLine& line : e.lines) note_reversals(e, line, out);
  for (const TableLine& line : e.lines) note_grids(e, line, out);
  for (const std::string& one : e.coarse) out.push_back("note: " + one);
  if (e.makes_worse()) {
    out.push_back(
        fmt::format("note: worse at some poses off the lines of the tables: TCP off by up to {} "
                    "without them, {} with",
                    size_of(false, e.volume.before), size_of(false, e.volume.after)));
  }
  add_omitted(e, out);
  for (const std::string& line : undetermined_lines(e)) out.push_back("note: " + line);
  add_table_count(e, out);
  if (e.rules().power_of_two) note_powers_of_two(e, out);
}

// Does linear interpolation leave more than a digit?
bool is_interpolated(const TableExport& e) {
  return std::any_of(e.tables.begin(), e.tables.end(), [&](const CompensationTable& table) {
    return table.residual > (table.is_angle() ? e.rules().angle_step : e.rules().length_step);
  });
}

// Formats that hold the errors themselves.
void add_unheld(const TableExport& e, std::vector<std::string>& out) {
  if (e.rules().tool_side) {
    std::string written;
    for (const TableLine& line : e.lines) {
      const Axis axis = *e.source.chain.layout.axis[static_cast<std::size_t>(line.joint)];
      for (const Axis direction : kAllAxes) {
        const plant::ErrorName name{direction, axis, true};
        if (e.source.errors.location(name) == 0.0) continue;
        written +=
            fmt::format("{}{}0{}", written.empty() ? "" : ", ", letter(direction), letter(axis));
      }
    }
    out.push_back(fmt::format("position errors: {}; the others of the redundant set are 0",
                              written.empty() ? "none" : written));
  }
  const bool has_reversal = std::any_of(e.lines.begin(), e.lines.end(), [&](const TableLine& line) {
    const Axis axis = *e.source.chain.layout.axis[static_cast<std::size_t>(line.joint)];
    return std::any_of(kAllAxes.begin(), kAllAxes.end(), [&](Axis direction) {
      return !e.source.errors.component({direction, axis, false}).reversals.empty();
    });
  });
  out.push_back(
      has_reversal && e.rules().direction == DirectionRule::none
          ? "not in these tables: the dependence on the direction of travel (notes)"
          : fmt::format("not in these tables: none{}",
                        is_interpolated(e) ? " except the residual of linear interpolation" : ""));
}

}  // namespace

std::vector<std::string> report(const TableExport& e) {
  std::vector<std::string> out;
  if (e.rules().skew) {
    if (e.skew) out = skew_report(e);
    if (e.mesh) {
      for (std::string& line : mesh_report(e)) out.push_back(std::move(line));
    }
    for (const TableLine& line : e.lines) note_grids(e, line, out);
    return with_unknown(std::move(out), e);
  }
  const bool csv = e.rules().components;
  out.push_back(
      fmt::format("compensation tables of error model '{}' on {}", e.request.model, e.machine));
  out.push_back(fmt::format("document: {}", e.rules().document));
  if (!csv) out.push_back(reference_line(e));
  add_base(e, out);
  out.push_back("tables:");
  for (const CompensationTable& table : e.tables) out.push_back(line_of(e, table));
  for (const GridTable& grid : e.grids) out.push_back(line_of(grid));
  add_notes(e, out);
  out = with_unknown(std::move(out), e);
  if (csv) {
    add_unheld(e, out);
    return out;
  }
  add_table_residuals(e, out);
  out.push_back(
      fmt::format("TCP at poses all over the travel, relative to the reference: off by up to {} "
                  "without these tables, {} with",
                  size_of(false, e.volume.before), size_of(false, e.volume.after)));
  return out;
}

}  // namespace servomill::sim::tables

#include "sim/tables/exchange_files.h"

#include <fmt/format.h>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"

namespace servomill::sim::tables {
namespace {

Axis axis_of_line(const TableExport& e, const TableLine& line) {
  return *e.source.chain.layout.axis[static_cast<std::size_t>(line.joint)];
}

// Values in mm or rad, with the last digit that the format rules name.
std::string value_text(double value, bool is_angle) {
  const std::string text =
      is_angle ? fmt::format("{:.9f}", value) : fmt::format("{:.6f}", value / mm);
  const bool is_zero = text.find_first_not_of("-0.") == std::string::npos;
  return is_zero && text.front() == '-' ? text.substr(1) : text;
}

std::string argument_text(const TableLine& line, std::size_t i) {
  return fmt::format("{:.6f}", line.entry(i) / (line.joint < kLinearJoints ? mm : deg) + 0.0);
}

std::string argument_text(Axis axis, double position) {
  return fmt::format("{:.6f}", position / (is_linear(axis) ? mm : deg) + 0.0);
}

std::string parameter_name(const plant::ErrorName& name) {
  return name.is_location ? fmt::format("{}0{}", letter(name.direction), letter(name.axis))
                          : to_string(name);
}

std::vector<plant::ErrorName> locations_of(const TableExport& e) {
  std::vector<plant::ErrorName> names;
  for (const TableLine& line : e.lines) {
    for (const Axis direction : kAllAxes) {
      const plant::ErrorName name{direction, axis_of_line(e, line), true};
      if (e.source.errors.location(name) != 0.0) names.push_back(name);
    }
  }
  return names;
}

std::string location_text(const TableExport& e, const plant::ErrorName& name) {
  return value_text(e.source.errors.location(name), !is_linear(name.direction));
}

std::vector<const CompensationTable*> tables_over(const TableExport& e, const TableLine& line) {
  std::vector<const CompensationTable*> tables;
  for (const CompensationTable& table : e.tables) {
    if (table.line.joint == line.joint) tables.push_back(&table);
  }
  return tables;
}

// One record for each combination of positions, the last argument the fastest.
std::string grid_text(const GridTable& grid) {
  const plant::GridPoints& points = grid.points;
  std::string text;
  for (const Axis axis : points.axes) text += fmt::format("{} ", letter(axis));
  text += parameter_name(grid.name) + "\n";
  for (std::size_t n = 0; n < points.error.size(); ++n) {
    std::string arguments;
    std::size_t rest = n;
    for (std::size_t k = points.axes.size(); k-- > 0;) {
      const std::vector<double>& at = points.at[k];
      arguments = argument_text(points.axes[k], at[rest % at.size()]) + " " + arguments;
      rest /= at.size();
    }
    text += arguments + value_text(points.error[n], grid.is_angle()) + "\n";
  }
  return text;
}

// Axes from the workpiece to the tool.
std::string chain_text(const TableExport& e) {
  std::string text;
  for (const plant::ChainAxis& axis : e.source.chain.axes) text += letter(axis.axis);
  return text;
}

TextFile notes_file(const TableExport& e, std::string_view name, std::string_view format,
                    std::size_t records) {
  std::vector<std::string> notes = report(e);
  notes.insert(
      notes.end(),
      {"values: deviation of the tool relative to the workpiece, in mm and rad; arguments in mm "
       "and deg",
       "tables over several axes form a grid: interpolation GRID, the default (P-VOLC-00014)",
       fmt::format("compensation list: chain {}, workpiece_axes 0, alternative_model 0, file[0] "
                   "{}, file_format[0] {}; start-up list: vol_comp[0].max_records >= {}",
                   chain_text(e), name, format, records),
       "workpiece_axes 0 treats every axis as carrying the tool; the errors of axes that carry the "
       "workpiece are converted accordingly",
       "assumed, for no document found has it: the component errors belong to the body that the "
       "axis moves (ISO 230-1), angles of linear axes turn about the machine zero, those of rotary "
       "axes about their centre; beyond the first and last point values are constant",
       "the centres of rotary axes (PXA ... PZC) and the zero position of the tool (P0X ... P0Z) "
       "are not in this file; TF5280 corrects the position of the tool, not its orientation",
       "check the sign of one error of each axis before relying on it"});
  std::string text;
  for (const std::string& note : notes) text += note + "\n";
  return {"notes.txt", text};
}

}  // namespace

std::vector<TextFile> isg_files(const TableExport& e) {
  std::string text = "// Geometric errors of " + e.machine + "; see notes.txt\n";
  std::size_t records = 0;
  const auto names = locations_of(e);
  if (!names.empty()) {
    std::string head, values;
    for (const plant::ErrorName& name : names) {
      head += fmt::format("{}{}", head.empty() ? "" : " ", parameter_name(name));
      values += fmt::format("{}{}", values.empty() ? "" : " ", location_text(e, name));
    }
    text += head + "\n" + values + "\n";
    ++records;
  }
  for (const TableLine& line : e.lines) {
    const auto tables = tables_over(e, line);
    if (tables.empty()) continue;
    if (records > 0) text += "#\n";
    text += e.letter(line.joint);
    for (const CompensationTable* table : tables) text += " " + parameter_name(*table->component);
    text += "\n";
    for (std::size_t i = 0; i < line.points; ++i) {
      text += argument_text(line, i);
      for (const CompensationTable* table : tables) {
        text += " " + value_text(table->error[i], table->is_angle());
      }
      text += "\n";
    }
    records += line.points;
  }
  for (const GridTable& grid : e.grids) {
    if (records > 0) text += "#\n";
    text += grid_text(grid);
    records += grid.points.error.size();
  }
  return {{"volcomp.csv", text}, notes_file(e, "volcomp.csv", "ISG_CSV", records)};
}

std::vector<TextFile> etalon_files(const TableExport& e) {
  std::string text = "// Geometric errors of " + e.machine + "; see notes.txt\n";
  std::size_t records = 0;
  for (const plant::ErrorName& name : locations_of(e)) {
    text += fmt::format("[{}]\nVALUE = {}\n", parameter_name(name), location_text(e, name));
    ++records;
  }
  for (const TableLine& line : e.lines) {
    for (const CompensationTable* table : tables_over(e, line)) {
      text += fmt::format("[{}]\nGridpoints = {{\n", parameter_name(*table->component));
      for (std::size_t i = 0; i < line.points; ++i) {
        text += fmt::format("{} {}\n", argument_text(line, i),
                            value_text(table->error[i], table->is_angle()));
      }
      text += fmt::format("}}  // end of {}\n", parameter_name(*table->component));
      records += line.points;
    }
  }
  return {{"volcomp.exc", text}, notes_file(e, "volcomp.exc", "ETALON_EXCHANGE", records)};
}

}  // namespace servomill::sim::tables

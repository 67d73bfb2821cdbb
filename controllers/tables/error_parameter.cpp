#include "controllers/tables/error_parameter.h"

#include <fmt/format.h>

#include <algorithm>

#include "controllers/tables/table_text.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {

std::string ErrorParameter::iso_name() const {
  return fmt::format("E{}{}{}", letter(direction), is_location ? "0" : "", letter(axis));
}

double ErrorParameter::unit() const { return is_linear(direction) ? mm : 1.0; }

std::optional<ErrorParameter> error_parameter_of(std::string_view name) {
  if (name.size() != 3) return std::nullopt;
  const bool is_location = name[1] == '0';
  if (!is_location && name[0] != 'E') return std::nullopt;
  const auto direction = axis_of(name[is_location ? 0 : 1]), axis = axis_of(name[2]);
  if (!direction || !axis) return std::nullopt;
  return ErrorParameter{*direction, *axis, is_location};
}

double coordinate_unit(Axis axis) { return is_linear(axis) ? mm : deg; }

namespace {

void refuse_repeated(const ErrorColumns& errors, const std::string& file, const std::string& name,
                     int line) {
  const auto is_it = [&](const auto& one) { return one.name == name; };
  if (std::any_of(errors.components.begin(), errors.components.end(), is_it) ||
      std::any_of(errors.grids.begin(), errors.grids.end(), is_it)) {
    refuse(file, line, fmt::format("{} appears twice", name));
  }
}

}  // namespace

void add_grid(ErrorColumns& errors, ErrorGrid grid) {
  refuse_repeated(errors, grid.file, grid.name, grid.line);
  errors.grids.push_back(std::move(grid));
}

void add_component(ErrorColumns& errors, ErrorColumn column, int line) {
  refuse_repeated(errors, column.file, column.name, line);
  if (column.points.size() < 2) {
    refuse(column.file, line,
           fmt::format("{}: {} points; must be >= 2", column.name, column.points.size()));
  }
  for (std::size_t i = 1; i < column.points.size(); ++i) {
    if (column.points[i].position > column.points[i - 1].position) continue;
    refuse(column.file, column.points[i].line,
           fmt::format("{}: the positions must increase", column.name));
  }
  errors.components.push_back(std::move(column));
}

void add_location(ErrorColumns& errors, const std::string& file, const ErrorParameter& parameter,
                  LocationValue value) {
  const std::string name = parameter.iso_name();
  if (errors.locations.contains(name)) {
    refuse(file, value.line, fmt::format("{} appears twice", name));
  }
  value.value *= parameter.unit();
  value.file = file;
  errors.locations[name] = value;
}

}  // namespace servomill::controllers

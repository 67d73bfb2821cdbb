#include "controllers/tables/csv_table.h"

#include <fmt/format.h>

#include "controllers/tables/table_text.h"
#include "plant/vocabulary/units.h"

namespace servomill::controllers {
namespace {

// Unit of an error, whose second letter is its direction.
double unit_of(std::string_view unit, std::string_view error, const std::string& file, int line) {
  const auto direction = error.size() >= 3 ? axis_of(error[1]) : std::nullopt;
  if (!direction) refuse(file, line, fmt::format("'{}' is not a geometric error", error));
  const std::string_view expected = is_linear(*direction) ? "um" : "urad";
  if (unit != expected) {
    refuse(file, line, fmt::format("{} in '{}'; must be in {}", error, unit, expected));
  }
  return is_linear(*direction) ? um : urad;
}

void read_locations(const TableText& file, const std::vector<std::string_view>& lines,
                    ErrorColumns& out) {
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const int number = static_cast<int>(i) + 1;
    const auto cells = cells_of(lines[i]);
    if (cells.size() != 3) refuse(file.name, number, "must be error, value, unit");
    const std::string name(cells[0]);
    if (out.locations.contains(name)) refuse(file.name, number, name + " appears twice");
    const double unit = unit_of(cells[2], name, file.name, number);
    out.locations[name] = {number_at(cells[1], file.name, number) * unit, number, file.name};
  }
}

// "EXX_up_um"
ErrorColumn column_of(std::string_view header, const TableText& file, double& unit) {
  ErrorColumn column{.file = file.name};
  const std::size_t last = header.rfind('_');
  if (last == std::string_view::npos) refuse(file.name, 1, fmt::format("'{}' has no unit", header));
  std::string_view name = header.substr(0, last);
  for (const int direction : {1, -1}) {
    const std::string_view ending = direction > 0 ? "_up" : "_down";
    if (!name.ends_with(ending)) continue;
    column.direction = direction;
    name.remove_suffix(ending.size());
  }
  column.name = name;
  unit = unit_of(header.substr(last + 1), name, file.name, 1);
  return column;
}

void read_components(const TableText& file, const std::vector<std::string_view>& lines,
                     ErrorColumns& out) {
  const auto headers = cells_of(lines[0]);
  const std::string_view place = headers[0];
  const auto axis = place.empty() ? std::nullopt : axis_of(place.front());
  if (!axis || place.substr(1) != (is_linear(*axis) ? "_mm" : "_deg")) {
    refuse(file.name, 1, fmt::format("'{}' is not an axis and its unit", place));
  }
  for (std::size_t n = 1; n < headers.size(); ++n) {
    double unit = 1.0;
    ErrorColumn column = column_of(headers[n], file, unit);
    column.base_axis = *axis;
    for (std::size_t i = 1; i < lines.size(); ++i) {
      const int number = static_cast<int>(i) + 1;
      const auto cells = cells_of(lines[i]);
      if (cells.size() != headers.size()) {
        refuse(file.name, number,
               fmt::format("{} values for {} columns", cells.size(), headers.size()));
      }
      const double value = number_at(cells[n], file.name, number) * unit;
      const double position =
          number_at(cells[0], file.name, number) * (is_linear(*axis) ? mm : deg);
      column.points.push_back({position, value, value, number});
    }
    out.components.push_back(std::move(column));
  }
}

}  // namespace

ErrorColumns read_csv_tables(std::span<const TableText> files) {
  ErrorColumns out;
  for (const TableText& file : files) {
    if (!std::string_view(file.name).ends_with(".csv")) continue;
    const auto lines = lines_of(file.text);
    if (lines.empty()) refuse(file.name, 1, "is empty");
    if (lines[0] == "error,value,unit") {
      read_locations(file, lines, out);
    } else {
      read_components(file, lines, out);
    }
  }
  return out;
}

}  // namespace servomill::controllers

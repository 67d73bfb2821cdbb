#include "sim/readings/columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "plant/vocabulary/user_file.h"
#include "sim/recordings/delimited_text.h"

namespace servomill::sim::readings {
namespace {

char separator_of(std::string_view line) {
  for (const char candidate : {';', '\t', ','}) {
    if (line.find(candidate) != std::string_view::npos) return candidate;
  }
  return ' ';
}

bool is_comment(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(" \t");
  if (begin == std::string_view::npos) return false;
  return line[begin] == '#' || line[begin] == '%' || line.substr(begin, 2) == "//";
}

// "Target [mm]" as "Target_mm".
std::string plain_heading(std::string_view written) {
  const recordings::Heading heading = recordings::parse_heading(written);
  return heading.unit.empty() ? heading.name : heading.name + "_" + heading.unit;
}

// Names in any case, and other words for some of them, as logs have them. Axes keep their case.
std::string known_name(const std::string& name) {
  if (name.size() < 2) return name;
  std::string lower = name;
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kOther = {
      {{"cycle", "run"},
       {"actual", "position"},
       {"actual position", "position"},
       {"measured", "position"},
       {"nominal", "target"},
       {"setpoint", "target"},
       {"target position", "target"},
       {"dir", "direction"}}};
  for (const auto& [other, known] : kOther) {
    if (lower == other) return std::string(known);
  }
  constexpr std::array<std::string_view, 13> kKnown = {
      "direction", "run",    "target",     "position", "deviation", "time", "angle",
      "sphere",    "length", "revolution", "dx",       "dz",        "dy"};
  const bool is_run =
      lower[0] == 'p' && lower.find_first_not_of("0123456789", 1) == std::string::npos;
  if (is_run || std::find(kKnown.begin(), kKnown.end(), lower) != kKnown.end()) return lower;
  return name;
}

Row row_of(const recordings::TextLine& line, char separator) {
  Row row{.line = line.number, .fields = {}, .columns = {}};
  for (const recordings::Field& field : recordings::split_fields(line.text, separator)) {
    row.fields.emplace_back(field.text);
    row.columns.push_back(field.column);
  }
  return row;
}

std::vector<std::string> written_names(const Table& table) {
  std::vector<std::string> out;
  for (const Column& column : table.columns) out.push_back(column.written);
  return out;
}

void check_names(const Table& table, int line, std::vector<Fault>& faults) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (table.columns[i].name != table.columns[j].name) continue;
      faults.push_back({{table.file, line, 0},
                        fmt::format("column {} appears twice", table.columns[i].written)});
    }
  }
}

}  // namespace

Column parse_column(std::string_view written, int number) {
  const std::string heading = plain_heading(written);
  Column column{.name = heading,
                .written = std::string(written),
                .unit = {.symbol = "", .quantity = config::kNumber, .factor = 1.0},
                .number = number};
  constexpr std::array kQuantities = {config::kLength, config::kAngle, config::kTime};
  for (const config::Quantity& quantity : kQuantities) {
    const auto unit = config::unit_of_key(heading, quantity);
    if (!unit) continue;
    column.unit = *unit;
    column.name = heading.substr(0, heading.rfind('_'));
    break;
  }
  column.name = known_name(column.name);
  return column;
}

const Column* Table::find(std::string_view name) const {
  const auto found = std::find_if(columns.begin(), columns.end(),
                                  [&](const Column& column) { return column.name == name; });
  return found == columns.end() ? nullptr : &*found;
}

const std::string& Table::text(const Row& row, const Column& column) const {
  return row.fields[static_cast<std::size_t>(column.number - 1)];
}

Place Table::place(const Row& row, const Column& column) const {
  return {file, row.line, row.columns[static_cast<std::size_t>(column.number - 1)]};
}

std::optional<double> Table::number(const Row& row, const Column& column,
                                    std::vector<Fault>& faults) const {
  const std::string& field = text(row, column);
  if (field.empty()) return std::nullopt;
  const auto value = recordings::parse_number(field, decimal);
  if (!value || !std::isfinite(*value)) {
    faults.push_back(
        {place(row, column), fmt::format("{} = {}; must be a number", column.written, field)});
    return 0.0;
  }
  return *value * column.unit.factor;
}

Table read_table(const std::string& path) {
  std::string why;
  const std::string text = read_input(path, kMaxBytesOfDocument, why);
  if (!why.empty()) throw InputError({path}, why);
  Table table;
  table.file = path;
  std::vector<Fault> faults;
  std::set<std::size_t> other_lengths;
  char separator = ',';
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  const std::string_view all =
      std::string_view(text).substr(text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0);
  for (const recordings::TextLine& line : recordings::text_lines(all)) {
    if (is_comment(line.text)) continue;
    if (table.columns.empty()) {
      separator = separator_of(line.text);
      int number = 0;
      for (const recordings::Field& field : recordings::split_fields(line.text, separator)) {
        table.columns.push_back(parse_column(field.text, ++number));
      }
      check_names(table, line.number, faults);
      continue;
    }
    Row row = row_of(line, separator);
    if (row.fields.size() == table.columns.size()) {
      table.rows.push_back(std::move(row));
    } else {
      other_lengths.insert(row.fields.size());
      faults.push_back({{path, line.number, 0},
                        fmt::format("has {} fields; the header has {}", row.fields.size(),
                                    table.columns.size())});
    }
  }
  if (separator == ';') {
    const bool has_comma = std::any_of(table.rows.begin(), table.rows.end(), [](const Row& row) {
      return std::any_of(row.fields.begin(), row.fields.end(), [](const std::string& field) {
        return field.find(',') != std::string::npos;
      });
    });
    if (has_comma) table.decimal = ',';
  }
  if (faults.size() > 1 && table.rows.empty() && other_lengths.size() == 1) {
    faults = {{{path, faults.front().place.line, 0},
               fmt::format("no row has the {} fields of the header \"{}\"; lines before "
                           "the header must start with #",
                           table.columns.size(), fmt::join(written_names(table), " "))}};
  }
  if (table.columns.empty()) faults.push_back({{path}, "is empty; expected a header line"});
  if (table.rows.empty() && faults.empty()) {
    faults.push_back({{path}, "has no readings after its header"});
  }
  if (!faults.empty()) throw InputError(std::move(faults));
  return table;
}

}  // namespace servomill::sim::readings

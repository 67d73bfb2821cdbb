#include "sim/standards/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "plant/vocabulary/units.h"
#include "sim/system/json.h"
#include "sim/system/text_table.h"

namespace servomill::sim::standards {
namespace {

struct Scale {
  double factor = 1.0;
  std::string_view symbol;
};

constexpr std::string_view si(Dimension dimension) {
  constexpr std::array<std::string_view, 4> kSymbols = {"m", "rad", "m/m", "1"};
  return kSymbols[static_cast<std::size_t>(dimension)];
}

// Micrometres, or nanometres where the largest value is below one; angles likewise.
Scale scale_of(Dimension dimension, double largest) {
  if (dimension == Dimension::count) return {1.0, ""};
  if (dimension == Dimension::ratio) return {um, "um/m"};
  const bool tiny = largest < um;
  if (dimension == Dimension::length) return tiny ? Scale{nm, "nm"} : Scale{um, "um"};
  return tiny ? Scale{1e-9, "nrad"} : Scale{urad, "urad"};
}

double largest_of(const Report& report, Dimension dimension) {
  double largest = 0.0;
  for (const ReportValue& one : report.values) {
    if (one.dimension != dimension || std::isnan(one.value)) continue;
    largest = std::max(largest, std::abs(one.value));
  }
  return largest;
}

double largest_of(const ReportTable& table, Dimension dimension) {
  double largest = 0.0;
  for (const ReportColumn& column : table.columns) {
    if (column.dimension != dimension || column.is_place) continue;
    for (const double value : column.values) {
      if (!std::isnan(value)) largest = std::max(largest, std::abs(value));
    }
  }
  return largest;
}

std::string number(double value, const Scale& scale) {
  constexpr double kLarge = 1000.0;  // beyond, no decimals
  if (std::isnan(value)) return "-";
  const double shown = value / scale.factor;
  if (scale.symbol.empty()) return fmt::format("{:g}", shown);
  if (std::abs(shown) >= kLarge) return fmt::format("{:.0f}", shown);
  return fmt::format("{:.{}f}", shown, scale.symbol.starts_with('n') ? 1 : 2);
}

std::string values_text(const Report& report) {
  const bool with_U = std::any_of(report.values.begin(), report.values.end(),
                                  [](const ReportValue& one) { return !std::isnan(one.U); });
  std::vector<std::vector<std::string>> lines = {{"parameter", "meaning", "value"}};
  if (with_U) lines.front().emplace_back("U (k = 2)");
  lines.front().emplace_back("unit");
  for (const ReportValue& one : report.values) {
    if (std::isnan(one.value)) continue;
    const Scale scale = scale_of(one.dimension, largest_of(report, one.dimension));
    lines.push_back({one.symbol, one.meaning, number(one.value, scale)});
    if (with_U) lines.back().push_back(number(one.U, scale));
    lines.back().emplace_back(scale.symbol);
  }
  return system::text_table(std::move(lines), 0, {2, with_U ? 3U : 2U});
}

std::string table_text(const ReportTable& table) {
  constexpr Scale kDegrees{deg, "deg"}, kMillimetres{mm, "mm"};
  std::vector<std::vector<std::string>> lines(1);
  std::set<std::size_t> right;
  if (!table.rows.empty()) {
    lines.front().push_back(table.name);
    for (const std::string& row : table.rows) lines.push_back({row});
  }
  for (const ReportColumn& column : table.columns) {
    Scale scale = scale_of(column.dimension, largest_of(table, column.dimension));
    if (column.is_place) scale = column.dimension == Dimension::angle ? kDegrees : kMillimetres;
    right.insert(lines.front().size());
    lines.front().push_back(scale.symbol.empty() ? column.name
                                                 : fmt::format("{} {}", column.name, scale.symbol));
    lines.resize(std::max(lines.size(), column.values.size() + 1));
    for (std::size_t i = 0; i < column.values.size(); ++i) {
      lines[i + 1].push_back(column.is_place
                                 ? fmt::format("{:.6g}", column.values[i] / scale.factor)
                                 : number(column.values[i], scale));
    }
  }
  return system::text_table(std::move(lines), 0, right);
}

std::string json(const ReportTable& table) {
  std::vector<std::string> columns;
  for (const ReportColumn& column : table.columns) {
    std::vector<std::string> numbers;
    numbers.reserve(column.values.size());
    for (const double value : column.values) numbers.push_back(system::json_number(value));
    columns.push_back(system::JsonObject()
                          .text("name", column.name)
                          .text("unit", si(column.dimension))
                          .raw("values", system::json_list(numbers))
                          .line());
  }
  return system::JsonObject()
      .text("name", table.name)
      .raw("rows", system::json_texts(table.rows))
      .raw("columns", system::json_list(columns))
      .line();
}

}  // namespace

std::string printed(const Report& report, bool with_all_tables) {
  std::string out = fmt::format("{}, {}: {}\n", report.standard, report.name, report.headline);
  for (const ReportTable& table : report.tables) {
    if (with_all_tables && table.on_request) out += "\n" + table_text(table);
  }
  out += "\n" + values_text(report);
  for (const ReportTable& table : report.tables) {
    if (!table.on_request) out += "\n" + table_text(table);
  }
  for (const std::string& remark : report.remarks) out += fmt::format("note: {}\n", remark);
  return out;
}

std::string json(const Report& report) {
  std::vector<std::string> values, tables;
  for (const ReportValue& one : report.values) {
    values.push_back(system::JsonObject()
                         .text("parameter", one.symbol)
                         .number("value", one.value)
                         .number("U", one.U)
                         .text("unit", si(one.dimension))
                         .line());
  }
  for (const ReportTable& table : report.tables) tables.push_back(json(table));
  return system::JsonObject()
      .text("standard", report.standard)
      .text("name", report.name)
      .text("headline", report.headline)
      .raw("parameters", system::json_list(values))
      .raw("tables", system::json_list(tables))
      .raw("notes", system::json_texts(report.remarks))
      .line();
}

std::string csv(const std::vector<Report>& reports) {
  const auto cell = [](double value) {
    return std::isnan(value) ? std::string() : fmt::format("{:.9g}", value);
  };
  std::string out = "test,standard,parameter,value,unit,U\n";
  for (const Report& report : reports) {
    for (const ReportValue& one : report.values) {
      std::string name = report.name;
      std::replace(name.begin(), name.end(), ',', ';');
      out += fmt::format("{},{},{},{},{},{}\n", name, report.standard, one.symbol, cell(one.value),
                         si(one.dimension), cell(one.U));
    }
  }
  return out;
}

}  // namespace servomill::sim::standards

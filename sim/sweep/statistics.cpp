#include "sim/sweep/statistics.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "sim/config/written_number.h"
#include "sim/evaluation/comparison.h"
#include "sim/records/input_file.h"
#include "sim/sweep/table_header.h"
#include "sim/system/json.h"
#include "sim/system/text_table.h"

namespace servomill::sim::sweep {
namespace {

constexpr double kLow = 0.025, kHigh = 0.975;

// @pre values are sorted, and there are some
double quantile(std::span<const double> values, double share) {
  const double at = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(at);
  if (below + 1 >= values.size()) return values.back();
  return values[below] + (at - static_cast<double>(below)) * (values[below + 1] - values[below]);
}

std::string attribute_of(const TableColumn& column, std::string_view name) {
  for (const auto& [key, value] : column.attributes) {
    if (key == name) return value;
  }
  return {};
}

// The keys of the grid with their values at one of its points.
std::string grid_text(const model::SweepDesign& design, std::uint64_t grid_point) {
  const std::vector<std::string> values = design.point(grid_point * design.samples.count);
  std::string out;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (design.keys[k].sampled) continue;
    out += fmt::format("{}{} = {}", out.empty() ? "" : ", ", design.keys[k].key, values[k]);
  }
  return out;
}

std::optional<model::Tolerance> tolerance_of(const TableColumn& column) {
  const std::string lower = attribute_of(column, "tolerance_lower");
  if (lower.empty()) return std::nullopt;
  const std::string upper = attribute_of(column, "tolerance_upper");
  return model::Tolerance{config::number_of(lower), config::number_of(upper)};
}

std::string shown_number(double value) {
  return std::isfinite(value) ? fmt::format("{:.5g}", value) : "-";
}

}  // namespace

Distribution distribution_of(std::span<const double> values) {
  std::vector<double> finite;
  std::copy_if(values.begin(), values.end(), std::back_inserter(finite),
               [](double value) { return std::isfinite(value); });
  Distribution out{finite.size(), kNoNumber, kNoNumber, kNoNumber, kNoNumber};
  if (finite.empty()) return out;
  const auto n = static_cast<double>(finite.size());
  double sum = 0.0;
  for (const double value : finite) sum += value;
  out.mean = sum / n;
  double squares = 0.0;
  for (const double value : finite) squares += (value - out.mean) * (value - out.mean);
  if (finite.size() > 1) out.deviation = std::sqrt(squares / (n - 1.0));
  if (finite.size() < kMinForInterval) return out;
  std::sort(finite.begin(), finite.end());
  out.low = quantile(finite, kLow);
  out.high = quantile(finite, kHigh);
  return out;
}

std::vector<SampledQuantity> sample_statistics(const std::string& table) {
  const records::InputFile file(table);
  const SweepHeader header = read_sweep_header(file);
  const model::SweepDesign& design = header.base.sweep;
  if (design.sampled_dimensions == 0) return {};
  std::map<std::uint64_t, std::vector<std::size_t>> rows;  // by point of the grid
  for (std::uint64_t place = 0; place < header.selection.size(); ++place) {
    rows[header.selection.point(place) / design.samples.count].push_back(place);
  }
  std::vector<TableColumn> columns = columns_of(file);
  std::erase_if(columns, [](const auto& one) { return attribute_of(one, "role") != "quantity"; });
  std::vector<std::vector<double>> values;
  for (const TableColumn& column : columns) {
    values.push_back(file.values(kSweepGroup + "/" + column.name));
  }
  std::vector<SampledQuantity> out;
  for (const auto& [grid_point, places] : rows) {
    const std::string grid = grid_text(design, grid_point);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      std::vector<double> some;
      for (const std::size_t place : places) some.push_back(values[c].at(place));
      SampledQuantity one{grid, columns[c], distribution_of(some), tolerance_of(columns[c])};
      if (one.tolerance) one.conformity = conformity_of(some, *one.tolerance);
      out.push_back(std::move(one));
    }
  }
  return out;
}

namespace {

constexpr std::array<std::string_view, 4> kConformityCells = {"tolerance", "within", "guard band",
                                                              "ISO 14253-1"};

constexpr std::string_view kConformityNote =
    "guard band: 1.65 standard deviations between the limits and the zone of acceptance (ISO "
    "14253-1, 95 %)\n";

// "+-20", "97.3 %", "4.1", "conforms"; empty cells where there is no tolerance.
std::vector<std::string> conformity_cells(const SampledQuantity& one) {
  if (!one.tolerance || !one.conformity) return {"", "", "", ""};
  const Conformity& found = *one.conformity;
  const bool has_value = std::isfinite(found.probability);
  return {evaluation::tolerance_text(*one.tolerance),
          has_value ? fmt::format("{:.1f} %", 100.0 * found.probability) : "-",
          shown_number(found.guard_band), has_value ? std::string(name_of(found.statement)) : "-"};
}

std::string conformity_json(const Conformity& found) {
  const bool has_value = std::isfinite(found.probability);
  return system::JsonObject()
      .number("probability", found.probability)
      .number("guard_band", has_value ? found.guard_band : kNoNumber)
      .text_or_null("statement", has_value ? name_of(found.statement) : "")
      .line();
}

}  // namespace

std::vector<std::string> statistics_json(const std::vector<SampledQuantity>& quantities) {
  std::vector<std::string> out;
  for (const SampledQuantity& one : quantities) {
    const Distribution& d = one.distribution;
    system::JsonObject object;
    object.text_or_null("grid", one.grid);
    for (const char* name : {"quantity", "axis", "statistic", "sections", "case"}) {
      object.text_or_null(name, attribute_of(one.column, name));
    }
    object.text("unit", one.column.meaning.units).integer("samples", d.count);
    object.number("mean", d.mean).number("standard_deviation", d.deviation);
    object.number("low_95", d.low).number("high_95", d.high);
    object.raw("conformity", one.conformity ? conformity_json(*one.conformity) : "null");
    out.push_back(object.line());
  }
  return out;
}

std::string format_statistics(const std::vector<SampledQuantity>& quantities, std::size_t most) {
  const bool has_grid = !quantities.empty() && !quantities.front().grid.empty();
  std::vector<std::vector<std::string>> lines = {{"quantity", "axis", "statistic", "section",
                                                  "case", "unit", "samples", "mean",
                                                  "standard deviation", "2.5 %", "97.5 %"}};
  const bool has_tolerances = std::any_of(quantities.begin(), quantities.end(),
                                          [](const auto& one) { return one.tolerance; });
  if (has_tolerances) {
    lines[0].insert(lines[0].end(), kConformityCells.begin(), kConformityCells.end());
  }
  for (const SampledQuantity& one : quantities) {
    if (lines.size() > most) break;
    const Distribution& d = one.distribution;
    const std::string& unit = one.column.meaning.units;
    lines.push_back({attribute_of(one.column, "quantity"), attribute_of(one.column, "axis"),
                     attribute_of(one.column, "statistic"), attribute_of(one.column, "sections"),
                     attribute_of(one.column, "case"), unit == "1" ? "" : unit,
                     fmt::format("{}", d.count), shown_number(d.mean), shown_number(d.deviation),
                     shown_number(d.low), shown_number(d.high)});
    if (!has_tolerances) continue;
    for (std::string& cell : conformity_cells(one)) lines.back().push_back(std::move(cell));
  }
  const std::size_t shown = lines.size() - 1;
  std::set<std::size_t> right = {6, 7, 8, 9, 10, 12, 13};
  std::size_t grouped = 4;
  if (has_grid) {
    lines.front().insert(lines.front().begin(), "grid");
    for (std::size_t n = 0; n < shown; ++n) {
      lines[n + 1].insert(lines[n + 1].begin(), quantities[n].grid);
    }
    right = {7, 8, 9, 10, 11, 13, 14};
    grouped = 5;
  }
  std::string out = system::text_table(std::move(lines), grouped, right);
  if (has_tolerances) out += kConformityNote;
  if (shown < quantities.size()) out += fmt::format("and {} more\n", quantities.size() - shown);
  return out;
}

}  // namespace servomill::sim::sweep

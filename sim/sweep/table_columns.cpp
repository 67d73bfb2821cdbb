#include "sim/sweep/table_columns.h"

#include <fmt/format.h>

#include <set>

#include "sim/evaluation/comparison.h"
#include "sim/model/design.h"
#include "sim/model/scenario.h"
#include "sim/records/input_file.h"
#include "sim/records/nexus.h"
#include "sim/run/result_file.h"
#include "sim/sweep/sweep.h"

namespace servomill::sim::sweep {
namespace {

constexpr double kNoText = -1.0;

// Letters, digits and single '_': a name that Octave, netCDF and pandas take.
std::string plain_name(std::string_view text) {
  std::string name;
  for (const char c : text) {
    const bool plain = (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
    if (plain) {
      name += c;
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  if (name.ends_with('_')) name.pop_back();
  const bool digit = name.empty() || (name[0] >= '0' && name[0] <= '9');
  return digit ? "n" + name : name;
}

class Names {
 public:
  std::string unique(const std::string& wanted) {
    std::string name = wanted;
    for (int n = 2; !taken_.insert(name).second; ++n) name = fmt::format("{}_{}", wanted, n);
    return name;
  }

 private:
  std::set<std::string> taken_ = {"point", "status", "reason", "simd_level"};
};

// The content of a TOML string without escapes; other values unchanged.
std::string unquoted(const std::string& toml) {
  const bool is_text = toml.size() >= 2 && (toml.front() == '"' || toml.front() == '\'') &&
                       toml.back() == toml.front() && toml.find('\\') == std::string::npos;
  return is_text ? toml.substr(1, toml.size() - 2) : toml;
}

TableColumn key_column(const model::SweepDesign& design, std::size_t key, Names& names) {
  const model::SweepColumn column = design.column(key);
  const std::string& full = design.keys[key].key;
  TableColumn out;
  out.name = names.unique(plain_name(full));
  out.meaning = {column.unit.empty() ? "1" : column.unit, full};
  out.attributes = {{"role", "parameter"}, {"key", full}};
  if (!column.numeric) {
    out.storage = records::Storage::int32;
    out.texts = column.texts;
    std::vector<std::string> shown;
    for (const std::string& text : column.texts) shown.push_back(unquoted(text));
    out.attributes.emplace_back("values", fmt::format("{}", fmt::join(shown, "\n")));
  }
  out.fill = column.numeric ? kNoNumber : kNoText;
  return out;
}

TableColumn quantity_column(const evaluation::ComparisonRow& row, Names& names) {
  TableColumn out;
  out.name = names.unique(plain_name(fmt::format("{} {} {} {} {}", row.case_name, row.quantity,
                                                 row.axis, row.statistic, row.sections)));
  std::string about = fmt::format("{} of {}", row.quantity, row.case_name);
  for (const std::string& more : {row.axis, row.statistic, row.sections}) {
    if (!more.empty()) about += ", " + more;
  }
  out.meaning = {row.unit, about};
  out.fill = kNoNumber;
  out.attributes = {{"role", "quantity"},         {"case", row.case_name},
                    {"quantity", row.quantity},   {"axis", row.axis},
                    {"statistic", row.statistic}, {"sections", row.sections},
                    {"reference", row.reference}, {"basis", row.basis}};
  if (row.tolerance) {
    out.attributes.emplace_back("tolerance_lower", fmt::format("{}", row.tolerance->lower));
    out.attributes.emplace_back("tolerance_upper", fmt::format("{}", row.tolerance->upper));
  }
  return out;
}

}  // namespace

std::vector<TableColumn> columns_of(const model::Scenario& base) {
  Names names;
  std::vector<TableColumn> columns;
  for (std::size_t key = 0; key < base.sweep.keys.size(); ++key) {
    columns.push_back(key_column(base.sweep, key, names));
  }
  for (const evaluation::ComparisonRow& row : quantities_of(base)) {
    columns.push_back(quantity_column(row, names));
  }
  return columns;
}

records::Plot plot_of(const std::vector<TableColumn>& columns) {
  std::vector<const TableColumn*> keys, quantities;
  for (const TableColumn& column : columns) {
    (column.attributes.front().second == "parameter" ? keys : quantities).push_back(&column);
  }
  const bool is_curve = keys.size() == 1 && keys.front()->texts.empty();
  records::Plot plot{"status", {is_curve ? keys.front()->name : "point"}, {}};
  if (quantities.empty()) return plot;
  plot.signal = quantities.front()->name;
  for (const TableColumn* one : quantities) {
    const bool fits = one->meaning.units == quantities.front()->meaning.units;
    if (fits && one != quantities.front()) plot.others.push_back(one->name);
  }
  return plot;
}

std::vector<TableColumn> columns_of(const records::InputFile& file) {
  std::vector<TableColumn> columns;
  for (const std::string& name : file.datasets(kSweepGroup)) {
    const std::string path = kSweepGroup + "/" + name;
    if (!file.has_attribute(path, "role")) continue;  // point, status, reason
    TableColumn column;
    column.name = name;
    column.meaning = file.meaning(path);
    column.fill = kNoNumber;
    for (const std::string_view about :
         {"role", "key", "values", "case", "quantity", "axis", "statistic", "sections", "reference",
          "basis", "tolerance_lower", "tolerance_upper"}) {
      const std::string attribute(about);
      if (!file.has_attribute(path, attribute)) continue;
      column.attributes.emplace_back(attribute, file.text(path, attribute));
      if (attribute != "values") continue;
      column.storage = records::Storage::int32;
      column.fill = kNoText;
      column.texts = run::split_lines(column.attributes.back().second);
    }
    columns.push_back(std::move(column));
  }
  return columns;
}

}  // namespace servomill::sim::sweep

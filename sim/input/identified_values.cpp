#include "sim/input/identified_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include "sim/config/quantity.h"
#include "sim/config/written_number.h"
#include "sim/model/joint_normal.h"

namespace servomill::sim::input {
namespace {

constexpr double kSameValue = 1e-12;  // relative; the conversion of a unit rounds

std::optional<double> number_in(const config::Value& value) {
  if (value.type == config::Value::Type::integer) return static_cast<double>(value.integer);
  if (value.type == config::Value::Type::real && std::isfinite(value.real)) return value.real;
  return std::nullopt;
}

// The covariance: as many rows as there are keys, each as long.
Eigen::MatrixXd read_covariance(config::Reader& table, std::size_t size) {
  const auto n = static_cast<Eigen::Index>(size);
  const std::size_t before = table.faults();
  const auto rows = table.rows("covariance");
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
  if (table.faults() > before) return out;
  const bool square =
      rows.size() == size &&
      std::all_of(rows.begin(), rows.end(), [&](const auto& row) { return row.size() == size; });
  if (!square) {
    table.fault("covariance", fmt::format("must be {0} rows of {0} numbers, one per key", size));
    return out;
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    out.row(i) = Eigen::Map<const Eigen::RowVectorXd>(rows[static_cast<std::size_t>(i)].data(), n);
  }
  if (const std::string fault = model::covariance_fault(out); !fault.empty()) {
    table.fault("covariance", fault);
  }
  return out;
}

void refuse_length(config::Reader& table, std::string_view name, std::size_t length,
                   std::size_t keys) {
  if (length == keys) return;
  table.fault(name, fmt::format("has {} items; must have {}, one per key", length, keys));
}

void refuse_repeated_keys(config::Reader& table, const IdentifiedValues& values) {
  for (std::size_t k = 0; k < values.keys.size(); ++k) {
    const auto before = values.keys.begin() + static_cast<std::ptrdiff_t>(k);
    if (std::find(values.keys.begin(), before, values.keys[k]) != before) {
      table.fault("keys", fmt::format("lists {} twice", values.keys[k]));
    }
  }
  for (const std::string& key : values.unidentifiable) {
    if (std::find(values.keys.begin(), values.keys.end(), key) == values.keys.end()) continue;
    table.fault(
        "unidentifiable",
        fmt::format(
            "lists {}, which is also one of keys; a key is either identified or unidentifiable",
            key));
  }
}

// "value_um[3][0]" as "value_um" and 3, 0; without indices: the whole.
std::pair<std::string_view, std::vector<std::size_t>> name_and_indices(std::string_view part) {
  const std::size_t bracket = part.find('[');
  if (bracket == std::string_view::npos || part.back() != ']') return {part, {}};
  std::vector<std::size_t> indices;
  for (std::string_view rest = part.substr(bracket); !rest.empty();) {
    const std::size_t end = rest.find(']');
    if (rest.front() != '[' || end == std::string_view::npos) return {part, {}};
    std::size_t index = 0;
    for (const char digit : rest.substr(1, end - 1)) {
      if (digit < '0' || digit > '9') return {part, {}};
      index = 10 * index + static_cast<std::size_t>(digit - '0');
    }
    indices.push_back(index);
    rest.remove_prefix(end + 1);
  }
  return {part.substr(0, bracket), indices};
}

const config::Value* item_of(const config::Value* list, std::size_t index) {
  if (list == nullptr || list->type != config::Value::Type::list) return nullptr;
  return index < list->children.size() ? &list->children[index] : nullptr;
}

// A value in a unit; nothing if it is no number of this kind.
std::optional<double> value_in(const config::Value& value, std::string_view key,
                               const std::string& unit) {
  const auto wanted = unit == kPlainNumber ? config::Unit{}
                                           : config::parse_unit(unit).unit.value_or(config::Unit{});
  if (const auto number = number_in(value)) {
    if (unit == kPlainNumber) return number;
    const std::size_t dot = key.rfind('.');
    const auto own =
        config::unit_of_key(name_and_indices(key.substr(dot + 1)).first, wanted.quantity);
    return *number * (own ? own->factor : 1.0) / wanted.factor;
  }
  if (value.type != config::Value::Type::text) return std::nullopt;
  const auto written = config::written_number(value.written);
  if (!written) return std::nullopt;
  if (written->unit == unit) return written->value;
  const config::Unit own = *config::parse_unit(written->unit).unit;
  if (own.quantity != wanted.quantity) return std::nullopt;
  return written->value * own.factor / wanted.factor;
}

// The values of the table are those that the machine of the same file has.
void refuse_other_values(config::Reader& table, const IdentifiedValues& identified,
                         const config::Value& file) {
  for (std::size_t k = 0; k < identified.keys.size(); ++k) {
    const std::string& key = identified.keys[k];
    const config::Value* set = value_at(file, key);
    if (set == nullptr || key.starts_with("identified.")) {
      table.fault("keys", fmt::format("lists {}, which this file does not set", key));
      continue;
    }
    const double value = identified.values[k];
    const std::string& unit = identified.units[k];
    if (is_same_number(*set, key, value, unit)) continue;
    table.fault("values", fmt::format("sets {} to {}{}, but line {} sets it to {}", key, value,
                                      unit == kPlainNumber ? "" : " " + unit, set->place.line,
                                      config::inline_toml(*set)));
  }
}

std::string list_of_texts(const std::vector<std::string>& texts) {
  std::vector<std::string> quoted;
  for (const std::string& text : texts) quoted.push_back(config::quoted_text(text));
  return fmt::format("[{}]", fmt::join(quoted, ", "));
}

}  // namespace

IdentifiedValues read_identified_table(config::Reader& table) {
  const std::size_t before = table.faults();
  IdentifiedValues out;
  out.keys = table.texts("keys");
  out.units = table.texts("units");
  out.values = table.reals("values", config::kNumber);
  out.unidentifiable = table.texts_or("unidentifiable", {});
  if (table.faults() == before && out.keys.empty())
    table.fault("keys", "must list at least one key");
  if (table.faults() > before) {
    table.raw("covariance");
    return {};
  }
  refuse_length(table, "units", out.units.size(), out.keys.size());
  refuse_length(table, "values", out.values.size(), out.keys.size());
  out.covariance = read_covariance(table, out.keys.size());
  for (const std::string& unit : out.units) {
    if (unit == kPlainNumber) continue;
    const config::ParsedUnit parsed = config::parse_unit(unit);
    if (!parsed.unit) {
      table.fault("units", parsed.complaint + "; use \"1\" for a dimensionless number");
    }
  }
  refuse_repeated_keys(table, out);
  return table.faults() > before ? IdentifiedValues() : out;
}

const config::Value* value_at(const config::Value& root, std::string_view key) {
  const config::Value* at = &root;
  while (at != nullptr && !key.empty()) {
    const std::size_t dot = key.find('.');
    const auto [name, indices] = name_and_indices(key.substr(0, dot));
    if (at->type != config::Value::Type::table) return nullptr;
    at = at->find(name);
    for (const std::size_t index : indices) at = item_of(at, index);
    key = dot == std::string_view::npos ? std::string_view() : key.substr(dot + 1);
  }
  return at;
}

bool is_same_number(const config::Value& value, std::string_view key, double number,
                    const std::string& unit) {
  const auto found = value_in(value, key, unit);
  return found && std::abs(*found - number) <= kSameValue * std::abs(number);
}

std::string table_lines(const IdentifiedValues& identified) {
  std::vector<std::string> rows;
  for (const auto& row : identified.covariance.rowwise()) {
    rows.push_back(fmt::format("[{}]", fmt::join(row.begin(), row.end(), ", ")));
  }
  return fmt::format(
      "keys = {}\nunits = {}\nvalues = [{}]\n"
      "covariance = [  # products of the units\n  {},\n]\nunidentifiable = {}\n",
      list_of_texts(identified.keys), list_of_texts(identified.units),
      fmt::join(identified.values, ", "), fmt::join(rows, ",\n  "),
      list_of_texts(identified.unidentifiable));
}

std::optional<IdentifiedValues> read_identified(config::Reader& machine) {
  if (!machine.has("identified")) {
    for (const std::string& key : machine.keys()) machine.raw(key);
    return std::nullopt;
  }
  config::Reader table = machine.table("identified");
  IdentifiedValues out = read_identified_table(table);
  config::Value file;
  for (const std::string& key : machine.keys()) {
    if (key == "identified") continue;
    if (const config::Value* value = machine.raw(key)) file.children.push_back(*value);
  }
  refuse_other_values(table, out, file);
  return out;
}

}  // namespace servomill::sim::input

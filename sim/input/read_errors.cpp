#include "sim/input/read_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "plant/vocabulary/units.h"
#include "sim/input/machine_description.h"
#include "sim/input/machine_document.h"
#include "sim/input/read_machine.h"

namespace servomill::sim::input {
namespace {

using plant::ErrorFunction;
using plant::ErrorName;

constexpr std::string_view kRelativeTo = "relative_to";
constexpr double kLargestShift = 0.1;  // m, of a location error
constexpr double kLargestAngle = 0.1;  // rad

// Units of one error: of its value (um or urad) and of its axis' coordinate (mm or deg).
struct Units {
  bool value_is_length, travel_is_length;
  std::string value(std::string_view what) const {
    return fmt::format("{}_{}", what, value_is_length ? "um" : "urad");
  }
  std::string travel(std::string_view what) const {
    return fmt::format("{}_{}", what, travel_is_length ? "mm" : "deg");
  }
  config::Quantity value_quantity() const {
    return value_is_length ? config::kLength : config::kAngle;
  }
  config::Quantity travel_quantity() const {
    return travel_is_length ? config::kLength : config::kAngle;
  }
};

Units units_of(const ErrorName& name) { return {is_linear(name.direction), is_linear(name.axis)}; }

ErrorFunction read_harmonic(config::Reader& table, const Units& units) {
  const double amplitude = table.real(units.value("amplitude"), units.value_quantity());
  const double period =
      table.real(units.travel("period"), units.travel_quantity(), {config::above(0.0)});
  const double phase = table.real_or("phase_deg", 0.0, config::kAngle);
  return period > 0.0 ? plant::harmonic(amplitude, period, phase) : ErrorFunction{};
}

ErrorFunction read_table(config::Reader& table, const Units& units) {
  auto at = table.reals(units.travel("at"), units.travel_quantity());
  auto values = table.reals(units.value("value"), units.value_quantity());
  const auto in_unit = [](std::vector<double> all, double unit) {
    for (double& x : all) x /= unit;
    return all;
  };
  // asked in the units of the keys, so that it shows the numbers that the user wrote
  const double travel = units.travel_is_length ? mm : deg;
  if (const auto fault = plant::table_fault(in_unit(at, travel), in_unit(values, um))) {
    table.fault(*fault);
    return {};
  }
  return plant::linear_table(std::move(at), std::move(values));
}

// c_n in value unit per travel unit^n; SI inside.
std::vector<double> read_coefficients(config::Reader& table, const std::string& key,
                                      const Units& units) {
  auto coefficients = table.reals(key, units.value_quantity());
  const double travel = units.travel_is_length ? mm : deg;
  double scale = 1.0;
  for (double& c : coefficients) {
    c *= scale;
    scale /= travel;
  }
  return coefficients;
}

ErrorFunction read_reversal(config::Reader& table, const Units& units) {
  const std::string constant = units.value("width"), curve = units.value("width_polynomial");
  std::vector<double> width = {0.0};
  if (table.has(curve)) width = read_coefficients(table, curve, units);
  if (table.has(constant) || !table.has(curve)) {
    width.resize(std::max<std::size_t>(width.size(), 1));
    width.front() += table.real(constant, units.value_quantity());
  }
  const double distance =
      table.real(units.travel("distance"), units.travel_quantity(), {config::above(0.0)});
  return distance > 0.0 ? plant::reversal(std::move(width), distance) : ErrorFunction{};
}

ErrorFunction read_function(config::Reader& table, const Units& units) {
  ErrorFunction sum;
  if (table.has(units.value("constant"))) {
    sum = sum + plant::constant(table.real(units.value("constant"), units.value_quantity()));
  }
  if (const std::string key = units.value("polynomial"); table.has(key)) {
    sum = sum + plant::polynomial(read_coefficients(table, key, units));
  }
  if (units.value_is_length && units.travel_is_length && table.has("um_per_m")) {
    sum = sum + plant::polynomial({0.0, table.real("um_per_m", config::kNumber) * um});
  }
  if (table.has("harmonic")) {
    if (table.is("harmonic", config::Value::Type::list)) {
      for (config::Reader& one : table.tables("harmonic")) sum = sum + read_harmonic(one, units);
    } else {
      config::Reader one = table.table("harmonic");
      sum = sum + read_harmonic(one, units);
    }
  }
  if (table.has("table")) {
    config::Reader points = table.table("table");
    sum = sum + read_table(points, units);
  }
  return sum;
}

// Squareness as it is measured: "0.2 mm/m", "50 um/m".
bool is_slope(config::Reader& model, std::string_view key) {
  if (!model.is(key, config::Value::Type::text)) return false;
  const config::ScaledText slope = config::scale_text(model.text(key), config::kNumber);
  return slope.complaint.empty();
}

ErrorFunction read_grids(config::Reader& table, bool is_length, const MachineAxes& machine) {
  ErrorFunction sum;
  if (table.is("grid", config::Value::Type::list)) {
    for (config::Reader& one : table.tables("grid")) sum = sum + read_grid(one, is_length, machine);
  } else if (table.has("grid")) {
    config::Reader one = table.table("grid");
    sum = read_grid(one, is_length, machine);
  }
  return sum;
}

// A bare number is in m or rad: one that was meant in um or um/m would pass for kilometres.
double read_bare_location(config::Reader& model, std::string_view key, const Units& units) {
  double value = 0.0;
  if (!units.value_is_length && is_slope(model, key)) {
    value = config::scale_text(model.text(key), config::kNumber).si;
  } else {
    value = model.real(key, units.value_quantity());
  }
  if (std::abs(value) <= (units.value_is_length ? kLargestShift : kLargestAngle)) return value;
  model.fault(key, units.value_is_length
                       ? "exceeds 0.1 m, which is implausible; a number without a unit is in m: "
                         "write \"8 um\" or { constant_um = 8.0 }"
                       : "exceeds 0.1 rad, which is implausible; a number without a unit is in "
                         "rad: write \"50 urad\" or { um_per_m = 50.0 }");
  return 0.0;
}

// A location error: a number with its unit in a text, or a table with one key.
double read_location(config::Reader& model, std::string_view key, const ErrorName& name) {
  const Units units = units_of(name);
  if (!model.is(key, config::Value::Type::table)) return read_bare_location(model, key, units);
  config::Reader table = model.table(key);
  if (!units.value_is_length && table.has("um_per_m"))
    return table.real("um_per_m", config::kNumber) * urad;
  return table.real(units.value("constant"), units.value_quantity());
}

// Name of the model that this one differs from; empty: from none.
std::string read_base(config::Reader& model, const std::string& name, config::Reader& models) {
  if (!model.has(kRelativeTo)) return "";
  const std::string base = model.text(kRelativeTo);
  if (!model.is(kRelativeTo, config::Value::Type::text)) return "";
  const std::vector<std::string> names = models.keys();
  if (base == name || std::find(names.begin(), names.end(), base) == names.end()) {
    const std::vector<std::string_view> others(names.begin(), names.end());
    model.fault(kRelativeTo, "must be the name of another error model" +
                                 (base == name ? "" : did_you_mean(base, others)));
    return "";
  }
  if (models.table(base).has(kRelativeTo)) {
    model.fault(kRelativeTo, "must name a model that is not itself relative to another");
    return "";
  }
  return base;
}

}  // namespace

plant::ErrorFunction read_length_function(config::Reader& table) {
  return read_function(table, {true, true});
}

plant::ErrorModel read_errors(config::Reader& model, const MachineAxes& machine) {
  plant::ErrorModel errors;
  std::map<std::string, std::string> aliases;
  std::set<std::string> known;
  for (const std::string& key : model.keys()) {
    if (key == kRelativeTo) continue;
    std::optional<ErrorName> name;
    try {
      name = plant::parse_error_name(key, machine.layout, {});
    } catch (const InputError& error) {
      model.raw(key);
      model.fault(key, error.faults().front().message);
      continue;
    }
    known.insert(key);
    if (name->is_location) {
      errors.location(*name) = read_location(model, key, *name);
    } else if (model.is(key, config::Value::Type::text)) {
      aliases[key] = model.text(key);
    } else {
      config::Reader table = model.table(key);
      const Units units = units_of(*name);
      errors.component(*name) =
          read_function(table, units) + read_grids(table, units.value_is_length, machine);
      if (table.has("reversal")) {
        config::Reader reversal = table.table("reversal");
        errors.component(*name) = errors.component(*name) + read_reversal(reversal, units);
      }
    }
  }
  for (const auto& [key, other] : aliases) {
    const auto target = plant::error_name_of(other);
    if (!target || !known.contains(other) || aliases.contains(other) || target->is_location) {
      model.fault(key, "must be the name of another error of this model that has its own function");
      continue;
    }
    const auto name = *plant::error_name_of(key);
    if (units_of(name).value_is_length != units_of(*target).value_is_length ||
        units_of(name).travel_is_length != units_of(*target).travel_is_length) {
      model.fault(key, "must name an error of the same unit over an axis of the same kind");
      continue;
    }
    errors.component(name) = errors.component(*target);
  }
  return errors;
}

std::map<std::string, plant::ErrorModel> read_error_models(config::Reader& models,
                                                           const MachineAxes& machine) {
  std::map<std::string, plant::ErrorModel> out;
  std::map<std::string, std::string> base_of;
  for (const std::string& name : models.keys()) {
    config::Reader model = models.table(name);
    base_of[name] = read_base(model, name, models);
    out[name] = read_errors(model, machine);
  }
  for (const auto& [name, base] : base_of) {
    if (!base.empty()) out[name] = out[base] + out[name];
  }
  return out;
}

std::map<std::string, plant::ErrorModel> read_error_file(const std::string& path,
                                                         const MachineAxes& machine) {
  if (is_machine_file(path)) {  // with its own errors
    MachineDescription described = read_machine_description(path);
    if (described.machine->chain.layout == machine.layout) return std::move(described.errors);
    throw InputError({path}, "contains the errors of a machine with other axes");
  }
  const config::Document document = config::Document::from_file(path);
  config::Reader root(document);
  config::Reader models = root.table("errors");
  auto out = read_error_models(models, machine);
  root.finish();
  return out;
}

}  // namespace servomill::sim::input

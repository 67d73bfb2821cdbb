#include "sim/calibration/identified_errors.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plant/vocabulary/units.h"
#include "sim/calibration/short_waves.h"
#include "sim/input/write_identified.h"

namespace servomill::sim::calibration {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using plant::ErrorFunction;
using plant::ErrorName;

// One number of a function in the file: its key behind the name, its size in SI.
struct Entry {
  std::string key;   // "table.value_um[3]"
  std::string unit;  // "um"; of coefficients of powers "1"
  double si = 1.0;   // SI of one
};

struct Names {
  std::string value;   // "um", "urad"
  std::string travel;  // "mm", "deg"
  double travel_si;    // m, rad
};

Names names_of(const ErrorName& name) {
  const bool linear = is_linear(name.axis);
  return {is_linear(name.direction) ? "um" : "urad", linear ? "mm" : "deg", linear ? mm : deg};
}

std::size_t powers_of(const FunctionForm& form, bool in_polynomial) {
  return in_polynomial ? static_cast<std::size_t>(std::max(2, form.degree + 1)) : 0;
}

// A function has a polynomial beside a table only for its degrees above 1.
bool has_polynomial(const FunctionForm& form) { return form.knots.empty() || form.degree > 1; }

std::vector<Entry> entries_of(const ErrorName& name, const FunctionForm& form) {
  const Names names = names_of(name);
  std::vector<Entry> out;
  double power = um;
  for (std::size_t k = 0; k < powers_of(form, has_polynomial(form)); ++k) {
    out.push_back({fmt::format("polynomial_{}[{}]", names.value, k), "1", power});
    power /= names.travel_si;
  }
  for (std::size_t k = 0; k < form.knots.size(); ++k) {
    out.push_back({fmt::format("table.value_{}[{}]", names.value, k), names.value, um});
  }
  for (std::size_t k = 0; k < 2 * form.periods.size(); ++k) {
    out.push_back({fmt::format("harmonic[{}].amplitude_{}", k, names.value), names.value, um});
  }
  power = um;
  for (int k = 0; k <= form.reversal_degree; ++k) {
    out.push_back({fmt::format("reversal.width_polynomial_{}[{}]", names.value, k), "1", power});
    power /= names.travel_si;
  }
  return out;
}

// The numbers of a function in the order of its entries, in their units.
VectorXd numbers_of(const ErrorFunction& f, const FunctionForm& form,
                    const std::vector<Entry>& entries) {
  std::vector<double> si = f.polynomial;
  si.resize(powers_of(form, has_polynomial(form)), 0.0);
  if (!form.knots.empty()) {
    si.insert(si.end(), f.tables.at(0).error.begin(), f.tables.at(0).error.end());
  }
  for (const plant::Harmonic& wave : f.harmonics) si.push_back(wave.amplitude);
  std::vector<double> width = f.reversals.empty() ? std::vector<double>() : f.reversals[0].width;
  width.resize(static_cast<std::size_t>(form.reversal_degree + 1), 0.0);
  si.insert(si.end(), width.begin(), width.end());
  VectorXd out(Index(entries.size()));
  for (std::size_t k = 0; k < entries.size(); ++k) out[Index(k)] = si.at(k) / entries[k].si;
  return out;
}

std::string list(const double* numbers, std::size_t count) {
  return fmt::format("[{}]", fmt::join(numbers, numbers + count, ", "));
}

// A function as the table of its error has it.
// @param short_periods  of waves whose amplitudes are 0, as far as is known
std::vector<std::string> parts_of(const ErrorName& name, const FunctionForm& form,
                                  const VectorXd& numbers,
                                  const std::vector<double>& short_periods) {
  const Names names = names_of(name);
  std::vector<std::string> parts;
  const double* at = numbers.data();
  if (const std::size_t powers = powers_of(form, has_polynomial(form)); powers > 0) {
    parts.push_back(fmt::format("polynomial_{} = {}", names.value, list(at, powers)));
    at += powers;
  }
  if (!form.knots.empty()) {
    std::vector<double> knots = form.knots;
    for (double& knot : knots) knot /= names.travel_si;
    parts.push_back(fmt::format("table = {{ at_{} = {}, value_{} = {} }}", names.travel,
                                list(knots.data(), knots.size()), names.value,
                                list(at, knots.size())));
    at += knots.size();
  }
  std::vector<std::string> waves;
  for (const double period : form.periods) {
    for (const int phase : {0, 90}) {
      waves.push_back(fmt::format("{{ amplitude_{} = {}, period_{} = {}, phase_deg = {} }}",
                                  names.value, *at++, names.travel, period / names.travel_si,
                                  phase));
    }
  }
  for (const double period : short_periods) {
    for (const int phase : {0, 90}) {
      waves.push_back(fmt::format("{{ amplitude_{} = 0.0, period_{} = {}, phase_deg = {} }}",
                                  names.value, names.travel, period / names.travel_si, phase));
    }
  }
  if (!waves.empty()) parts.push_back(fmt::format("harmonic = [{}]", fmt::join(waves, ", ")));
  if (form.reversal_degree >= 0) {
    parts.push_back(fmt::format("reversal = {{ width_polynomial_{} = {}, distance_{} = {} }}",
                                names.value, list(at, std::size_t(form.reversal_degree + 1)),
                                names.travel, form.reversal_distance / names.travel_si));
  }
  return parts;
}

// A grid as the file has it.
std::string grid_text(const ErrorName& name, const plant::GridPoints& points) {
  std::vector<std::string> at, rows;
  for (std::size_t axis = 0; axis < points.axes.size(); ++axis) {
    std::vector<double> shown = points.at[axis];
    for (double& position : shown) position /= is_linear(points.axes[axis]) ? mm : deg;
    at.push_back(list(shown.data(), shown.size()));
  }
  const std::size_t across = points.at[1].size();
  std::vector<double> values = points.error;
  for (double& value : values) value /= um;
  for (std::size_t i = 0; i < points.at[0].size(); ++i) {
    rows.push_back(list(values.data() + i * across, across));
  }
  const bool linear = is_linear(points.axes[0]);
  const char* units = linear != is_linear(points.axes[1]) ? "mm_deg" : linear ? "mm" : "deg";
  return fmt::format("{{ axes = \"{}{}\", at_{} = [{}], value_{} = [{}] }}", letter(points.axes[0]),
                     letter(points.axes[1]), units, fmt::join(at, ", "), names_of(name).value,
                     fmt::join(rows, ", "));
}

// Collects keys, units, values and the linear map from the unknowns to the numbers.
class Collector {
 public:
  Collector(const Adjustment& adjustment, const std::string& model)
      : adjustment_(adjustment), model_(model), periods_(number_of_periods()) {}

  IdentifiedErrors collect() {
    const Unknowns& unknowns = adjustment_.unknowns;
    for (std::size_t k = 0; k < unknowns.locations.size(); ++k) add_location(k);
    for (std::size_t f = 0; f < unknowns.functions.size(); ++f) add_function(f);
    for (const SoughtGrid& grid : unknowns.grids) add_grid(grid);
    add_components();
    const auto n = Index(out_.values.values.size());
    MatrixXd G = MatrixXd::Zero(n, unknowns.size());
    for (const auto& [row, column, factor] : map_) G(row, column) += factor;
    MatrixXd C = G * adjustment_.covariance * G.transpose();
    for (const WaveNumbers& one : waves_) {
      C.block(one.first, one.first, one.map.rows(), one.map.rows()) +=
          one.variance * one.map * one.map.transpose();
    }
    out_.values.covariance = 0.5 * (C + C.transpose());
    return std::move(out_);
  }

 private:
  bool is_known(int first, int count) const {
    return !adjustment_.covariance.block(first, first, count, count).isZero(0.0);
  }

  Index add_number(const std::string& key, const std::string& unit, double value) {
    out_.values.keys.push_back(fmt::format("errors.{}.{}", model_, key));
    out_.values.units.push_back(unit);
    out_.values.values.push_back(value);
    return Index(out_.values.values.size()) - 1;
  }

  void add_location(std::size_t k) {
    const ErrorName& name = adjustment_.unknowns.locations[k].name;
    const int unknown = adjustment_.unknowns.first_location() + int(k);
    if (!is_known(unknown, 1)) return;
    const std::string unit = is_linear(name.direction) ? "um" : "urad";
    const double value = adjustment_.values[unknown] / um;
    const Index row =
        add_number(fmt::format("{}.constant_{}", plant::to_string(name), unit), unit, value);
    map_.push_back({row, unknown, 1.0 / um});
    const double sigma = std::sqrt(adjustment_.covariance(unknown, unknown)) / um;
    out_.lines.push_back(fmt::format("{} = {{ constant_{} = {} }}  # +- {:.2g} {} (k = 2)",
                                     plant::to_string(name), unit, value, 2.0 * sigma, unit));
  }

  // Periods that short waves of each function have in the file, so that the covariance of all
  // numbers is written.
  int number_of_periods() const {
    constexpr int kUsual = 4;
    const Unknowns& unknowns = adjustment_.unknowns;
    std::size_t numbers = unknowns.locations.size(), with_waves = 0;
    for (std::size_t f = 0; f < unknowns.functions.size(); ++f) {
      const SoughtFunction& function = unknowns.functions[f];
      numbers += entries_of(function.name, function.basis.form()).size();
      if (adjustment_.short_waves.at(f) > 0.0) ++with_waves;
    }
    for (const SoughtGrid& grid : unknowns.grids) {
      numbers += grid.basis.points(VectorXd::Zero(grid.basis.size())).error.size();
    }
    const int free = kMaxCovarianceNumbers - static_cast<int>(numbers);
    return std::clamp(free / std::max(2 * static_cast<int>(with_waves), 1), 0, kUsual);
  }

  // Numbers of the waves between the knots of the function that was added last.
  void add_waves(const SoughtFunction& function, double size, Index first_entry,
                 const std::vector<Entry>& entries, const ShortWaves& waves) {
    const FunctionForm& form = function.basis.form();
    const std::string unit = names_of(function.name).value;
    const Index numbers = Index(entries.size()), count = waves.tables.cols();
    const Index table = Index(powers_of(form, has_polynomial(form))), knots = waves.tables.rows();
    WaveNumbers out{first_entry, size * size,
                    MatrixXd::Zero(numbers + count, count + waves.lines.cols())};
    out.map.block(table, 0, knots, count) = -waves.tables / um;
    out.map.block(table, count, knots, waves.lines.cols()) = waves.lines / um;
    for (Index k = 0; k < count; ++k) {
      add_number(fmt::format("{}.harmonic[{}].amplitude_{}", plant::to_string(function.name),
                             2 * form.periods.size() + std::size_t(k), unit),
                 unit, 0.0);
      out.map(numbers + k, k) = waves.amplitude / um;
    }
    waves_.push_back(std::move(out));
  }

  void add_function(std::size_t f) {
    const SoughtFunction& function = adjustment_.unknowns.functions[f];
    const int n = function.basis.size();
    if (!is_known(function.first, n)) return;
    const FunctionForm& form = function.basis.form();
    const std::vector<Entry> entries = entries_of(function.name, form);
    const VectorXd coefficients = adjustment_.values.segment(function.first, n);
    const VectorXd numbers = numbers_of(function.basis.function(coefficients), form, entries);
    const Index first = Index(out_.values.values.size());
    for (std::size_t k = 0; k < entries.size(); ++k) {
      add_number(plant::to_string(function.name) + "." + entries[k].key, entries[k].unit,
                 numbers[Index(k)]);
    }
    for (int i = 0; i < n; ++i) {
      const VectorXd column =
          numbers_of(function.basis.function(VectorXd::Unit(n, i)), form, entries);
      for (Index k = 0; k < column.size(); ++k) {
        if (column[k] != 0.0) map_.push_back({first + k, function.first + i, column[k]});
      }
    }
    const double size = adjustment_.short_waves.at(f);
    ShortWaves waves;
    if (size > 0.0 && periods_ > 0) {
      waves = short_waves_of(function.basis, periods_);
      add_waves(function, size, first, entries, waves);
    }
    components_.push_back(
        {function.name, parts_of(function.name, form, numbers, waves.periods), {}});
  }

  // Numbers of a grid have no unit in their list.
  void add_grid(const SoughtGrid& grid) {
    const int n = grid.basis.size();
    if (!is_known(grid.first, n)) return;
    const auto points = grid.basis.points(adjustment_.values.segment(grid.first, n));
    auto of = std::find_if(components_.begin(), components_.end(),
                           [&](const Component& one) { return one.name == grid.name; });
    if (of == components_.end()) of = components_.insert(of, {grid.name, {}, {}});
    const std::size_t across = points.at[1].size();
    const Index first = Index(out_.values.values.size());
    for (std::size_t k = 0; k < points.error.size(); ++k) {
      add_number(fmt::format("{}.grid[{}].value_{}[{}][{}]", plant::to_string(grid.name),
                             of->grids.size(), names_of(grid.name).value, k / across, k % across),
                 "1", points.error[k] / um);
    }
    for (int i = 0; i < n; ++i) {
      const auto column = grid.basis.points(VectorXd::Unit(n, i)).error;
      for (std::size_t k = 0; k < column.size(); ++k) {
        if (column[k] != 0.0) map_.push_back({first + Index(k), grid.first + i, column[k] / um});
      }
    }
    of->grids.push_back(grid_text(grid.name, points));
  }

  void add_components() {
    for (Component& one : components_) {
      if (!one.grids.empty()) {
        one.parts.push_back(fmt::format("grid = [{}]", fmt::join(one.grids, ", ")));
      }
      out_.lines.push_back(
          fmt::format("{} = {{ {} }}", plant::to_string(one.name), fmt::join(one.parts, ", ")));
    }
  }

  // Errors of variance 1 by the numbers that they change.
  struct WaveNumbers {
    Index first = 0;
    double variance = 0.0;  // m^2, rad^2
    MatrixXd map;           // numbers x errors
  };

  // Table of one component error.
  struct Component {
    ErrorName name;
    std::vector<std::string> parts, grids;
  };

  struct Part {
    Index row;
    int column;
    double factor;
  };
  const Adjustment& adjustment_;
  const std::string& model_;
  int periods_;
  std::vector<Part> map_;
  std::vector<WaveNumbers> waves_;
  std::vector<Component> components_;
  IdentifiedErrors out_;
};

}  // namespace

IdentifiedErrors identified_errors(const Calibration& calibration, const std::string& model) {
  IdentifiedErrors out = Collector(calibration.adjustment, model).collect();
  for (const ErrorName& name : undetermined_errors(calibration)) {
    out.values.unidentifiable.push_back(fmt::format("errors.{}.{}", model, plant::to_string(name)));
  }
  return out;
}

}  // namespace servomill::sim::calibration

#include "plant/geometry/error_function.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <utility>

namespace servomill::plant {
namespace {

// Index of the first point above `at`, from 1 to size - 1 inside the table.
std::size_t upper_point(const LinearTable& table, double at) {
  const auto above = std::upper_bound(table.s.begin(), table.s.end(), at);
  return static_cast<std::size_t>(above - table.s.begin());
}

double slope(const LinearTable& table, std::size_t i) {
  return (table.error[i] - table.error[i - 1]) / (table.s[i] - table.s[i - 1]);
}

bool all_zero(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return v == 0.0; });
}

double polynomial_at(const std::vector<double>& c, double s) {
  double sum = 0.0;
  for (std::size_t i = c.size(); i-- > 0;) sum = sum * s + c[i];
  return sum;
}

// A mistake of the caller, which a user's model must not turn into a wrong number.
void refuse_grids(const ErrorFunction& f) {
  if (!f.grids.empty()) throw std::logic_error("an error over several axes needs all coordinates");
}

}  // namespace

double Harmonic::omega() const { return 2.0 * std::numbers::pi / period; }

double Harmonic::value(double s) const { return amplitude * std::sin(omega() * s + phase); }

double Harmonic::derivative(double s) const {
  return amplitude * omega() * std::cos(omega() * s + phase);
}

double LinearTable::value(double at) const {
  const std::size_t i = upper_point(*this, at);
  if (i == 0) return error.front();
  if (i == s.size()) return error.back();
  return error[i - 1] + slope(*this, i) * (at - s[i - 1]);
}

double LinearTable::derivative(double at) const {
  const std::size_t i = upper_point(*this, at);
  return i == 0 || i == s.size() ? 0.0 : slope(*this, i);
}

double Reversal::value(double s) const { return polynomial_at(width, s); }

bool Reversal::is_zero() const { return all_zero(width); }

double ErrorFunction::value(double s) const {
  refuse_grids(*this);
  return value(s, AxisWords::Zero());
}

double ErrorFunction::value(double s, const AxisWords& q) const {
  double sum = polynomial_at(polynomial, s);
  for (const Harmonic& h : harmonics) sum += h.value(s);
  for (const LinearTable& t : tables) sum += t.value(s);
  for (const GridFunction& g : grids) sum += g.value(q);
  return sum;
}

std::vector<Axis> ErrorFunction::grid_axes() const {
  std::vector<Axis> axes;
  for (const Axis axis : kAllAxes) {
    const bool is_named = std::any_of(grids.begin(), grids.end(),
                                      [&](const GridFunction& g) { return g.depends_on(axis); });
    if (is_named) axes.push_back(axis);
  }
  return axes;
}

double ErrorFunction::derivative(double s) const {
  refuse_grids(*this);
  double sum = 0.0;
  for (std::size_t i = polynomial.size(); i-- > 1;) {
    sum = sum * s + static_cast<double>(i) * polynomial[i];
  }
  for (const Harmonic& h : harmonics) sum += h.derivative(s);
  for (const LinearTable& t : tables) sum += t.derivative(s);
  return sum;
}

double ErrorFunction::width(double s) const {
  double sum = 0.0;
  for (const Reversal& r : reversals) sum += r.value(s);
  return sum;
}

bool ErrorFunction::is_zero() const {
  return all_zero(polynomial) &&
         std::all_of(harmonics.begin(), harmonics.end(),
                     [](const Harmonic& h) { return h.amplitude == 0.0; }) &&
         std::all_of(tables.begin(), tables.end(),
                     [](const LinearTable& t) { return all_zero(t.error); }) &&
         std::all_of(reversals.begin(), reversals.end(), std::mem_fn(&Reversal::is_zero)) &&
         std::all_of(grids.begin(), grids.end(), std::mem_fn(&GridFunction::is_zero));
}

ErrorFunction constant(double c) { return polynomial({c}); }

ErrorFunction polynomial(std::vector<double> coefficients) {
  return {.polynomial = std::move(coefficients)};
}

ErrorFunction harmonic(double amplitude, double period, double phase) {
  assert(period > 0.0);
  return {.harmonics = {{amplitude, period, phase}}};
}

ErrorFunction reversal(std::vector<double> width, double distance) {
  assert(distance > 0.0);
  return {.reversals = {{std::move(width), distance}}};
}

ErrorFunction linear_table(std::vector<double> s, std::vector<double> error) {
  assert(!table_fault(s, error));
  return {.tables = {{std::move(s), std::move(error)}}};
}

ErrorFunction grid(GridPoints points) { return {.grids = {GridFunction(std::move(points))}}; }

std::optional<std::string> table_fault(const std::vector<double>& s,
                                       const std::vector<double>& error) {
  if (s.empty()) return "has no points; must have at least 1";
  if (s.size() != error.size()) {
    return fmt::format("has {} positions and {} errors; the numbers must be equal", s.size(),
                       error.size());
  }
  for (std::size_t i = 0; i < s.size(); ++i) {
    if (!std::isfinite(s[i]) || !std::isfinite(error[i])) {
      return fmt::format("has ({}, {}) at point {}; must be finite", s[i], error[i], i + 1);
    }
    if (i > 0 && !(s[i] > s[i - 1])) {
      return fmt::format("{} follows {} at point {}; positions must increase", s[i], s[i - 1],
                         i + 1);
    }
  }
  return std::nullopt;
}

ErrorFunction operator+(const ErrorFunction& f, const ErrorFunction& g) {
  ErrorFunction sum = f;
  sum.polynomial.resize(std::max(f.polynomial.size(), g.polynomial.size()), 0.0);
  for (std::size_t i = 0; i < g.polynomial.size(); ++i) sum.polynomial[i] += g.polynomial[i];
  sum.harmonics.insert(sum.harmonics.end(), g.harmonics.begin(), g.harmonics.end());
  sum.tables.insert(sum.tables.end(), g.tables.begin(), g.tables.end());
  sum.reversals.insert(sum.reversals.end(), g.reversals.begin(), g.reversals.end());
  sum.grids.insert(sum.grids.end(), g.grids.begin(), g.grids.end());
  return sum;
}

ErrorFunction scaled(const ErrorFunction& f, double factor) {
  ErrorFunction out = f;
  for (double& c : out.polynomial) c *= factor;
  for (Harmonic& h : out.harmonics) h.amplitude *= factor;
  for (LinearTable& t : out.tables) {
    for (double& e : t.error) e *= factor;
  }
  for (Reversal& r : out.reversals) {
    for (double& w : r.width) w *= factor;
  }
  for (GridFunction& g : out.grids) g = g.scaled(factor);
  return out;
}

ErrorFunction travelling(const ErrorFunction& f, double direction) {
  ErrorFunction out = f;
  out.reversals.clear();
  for (const Reversal& r : f.reversals) {
    out = out + scaled(polynomial(r.width), 0.5 * direction);
  }
  return out;
}

}  // namespace servomill::plant

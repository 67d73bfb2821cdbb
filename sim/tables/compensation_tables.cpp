#include "sim/tables/compensation_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/progress.h"
#include "plant/vocabulary/units.h"
#include "sim/tables/grid_tables.h"

namespace servomill::sim::tables {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;  // rad
constexpr double kSlack = 1e-9;                   // of an interval, for rounding
constexpr std::size_t kUsualPoints = 256;         // for a spacing that nobody asked for

std::size_t points_over(double length, double spacing) {
  const double intervals = std::ceil(length / spacing - kSlack);
  constexpr double kMax = 1e9;  // enough to be refused
  return static_cast<std::size_t>(std::clamp(intervals, 1.0, kMax)) + 1;
}

// The smallest spacing of a growing series with which the travel fits.
double first_that_fits(double length, std::size_t most, const std::function<double(int)>& series) {
  int n = 0;
  while (points_over(length, series(n)) > most) ++n;
  return series(n);
}

double round_series(double unit, int n) {
  constexpr std::array<double, 3> kMantissa = {1.0, 2.0, 5.0};
  constexpr int kFirstDecade = -4;
  return kMantissa[static_cast<std::size_t>(n % 3)] * std::pow(10.0, kFirstDecade + n / 3) * unit;
}

double fitting_spacing(double length, bool linear, std::size_t most, const FormatRules& rules) {
  if (linear && rules.power_of_two) {
    return first_that_fits(length, most, [](int n) { return std::ldexp(kGridStep, n); });
  }
  const double unit = linear ? mm : deg;
  return first_that_fits(length, most, [unit](int n) { return round_series(unit, n); });
}

// Error over the position of the axis and its direction of travel: 1, -1, 0 for the mean.
// A whole turn without ends: from 0 to 360 deg.
bool is_endless(const TableLine& line) {
  return line.one_turn && line.from == 0.0 && line.to == kTurn;
}

using Curve = std::function<double(double, int)>;

std::vector<double> rounded_values(const TableLine& line, const Curve& error, int direction,
                                   double step) {
  std::vector<double> out;
  for (std::size_t i = 0; i < line.points; ++i) {
    throw_if_interrupted();
    const double exact = error(line.position(line.entry(i)), direction);
    out.push_back(std::round(exact / step) * step + 0.0);
  }
  if (line.wraps && is_endless(line)) {
    constexpr double kHalfDigits = 1.5;  // the same value may round either way
    if (std::abs(out.back() - out.front()) <= kHalfDigits * step) out.back() = out.front();
  }
  return out;
}

CompensationTable tabulate(const TableLine& line, const Curve& error, double step,
                           bool by_direction) {
  CompensationTable table;
  table.line = line;
  table.error = rounded_values(line, error, by_direction ? 1 : 0, step);
  if (by_direction) table.error_down = rounded_values(line, error, -1, step);
  constexpr double kWithin = 8.0;  // places looked at between two points
  const double places = std::ceil((line.to - line.from) / line.spacing * kWithin - kSlack);
  for (double n = 0.0; n <= places; ++n) {
    const double q = std::min(line.from + n * line.spacing / kWithin, line.to);
    for (const int direction : {1, -1}) {
      const double exact = error(q, by_direction ? direction : 0);
      table.residual =
          std::max(table.residual, std::abs(table.at(line.entry_of(q), direction) - exact));
    }
  }
  return table;
}

// The displacements to first order: those of errors a million times smaller.
constexpr double kSmall = 1e-6;

TableSource scaled_down(TableSource source) {
  source.errors = plant::scaled(source.errors, kSmall);
  return source;
}

bool is_zero_to_first_order(const LineCorrection& small, const CompensationTable& table,
                            double step) {
  const TableLine& line = table.line;
  for (std::size_t i = 0; i < line.points; ++i) {
    const double d = small.over(line.joint, line.position(line.entry(i)))[table.output] / kSmall;
    if (std::abs(d) > 0.5 * step) return false;
  }
  return true;
}

// A table that repeats cannot hold an error that differs after one turn.
void refuse_jump(const TableSource& source, const CompensationTable& table) {
  const TableLine& line = table.line;
  if (!line.wraps || !is_endless(line)) return;
  for (const auto* values : {&table.error, &table.error_down}) {
    if (values->empty() || values->front() == values->back()) continue;
    const char axis = source.chain.layout.letter_of(line.joint);
    throw InputError(
        {},
        fmt::format(
            "the error of {0} after one revolution differs by {1:.2f} urad from that at the start, "
            "but the table is periodic; set --travel {0}=FROM:TO, or use a periodic error",
            axis, (values->back() - values->front()) / urad));
  }
}

bool holds_anything(const CompensationTable& table) { return table.largest() > 0.0; }

}  // namespace

double TableLine::position(double entry) const {
  const double middle_outside = 0.5 * (to + from + kTurn);
  return one_turn && entry > to && entry > middle_outside ? entry - kTurn : entry;
}

double TableLine::entry_of(double position) const {
  const bool within = position >= 0.0 && position <= kTurn;
  return one_turn && !within ? position - kTurn * std::floor(position / kTurn) : position;
}

TableLine make_line(const LineRequest& r, const FormatRules& rules) {
  const bool linear = r.joint < kLinearJoints, endless = !r.lower || !r.upper;
  if (linear && endless) {
    throw InputError({}, fmt::format("axis {0} has no travel; set --travel {0}=FROM:TO", r.letter));
  }
  TableLine line;
  line.joint = r.joint;
  line.wanted = r.wanted;
  line.from = r.lower.value_or(0.0);
  line.to = r.upper.value_or(kTurn);
  line.one_turn = !linear && (endless || (rules.one_turn && (line.from < 0.0 || line.to > kTurn)));
  line.wraps = line.one_turn && rules.wraps;
  const double first = line.one_turn ? 0.0 : line.from, last = line.one_turn ? kTurn : line.to;
  line.first = first;
  const double fits =
      fitting_spacing(last - first, linear, std::min(r.most_points, kUsualPoints), rules);
  line.spacing = r.spacing.value_or(fits);
  line.points = points_over(last - first, line.spacing);
  if (line.points <= r.most_points || !r.wanted) return line;

  const double unit = linear ? mm : deg;
  const char* name = linear ? "mm" : "deg";
  const double least = (last - first) / static_cast<double>(r.most_points - 1) / unit;
  throw InputError(
      {}, fmt::format("table over {}: {} points, {:g} {} apart, from {:g} to {:g} {}; at most {} "
                      "points are allowed; the smallest spacing that fits is {:g} {}",
                      r.letter, line.points, line.spacing / unit, name, first / unit, last / unit,
                      name, r.most_points,
                      linear && rules.power_of_two && !r.spacing ? fits / unit
                                                                 : std::ceil(least * 1e4) / 1e4,
                      name));
}

std::optional<TableLine> finer_line(TableLine line, const FormatRules& rules,
                                    std::size_t most_points) {
  const double length = static_cast<double>(line.points - 1) * line.spacing;
  const bool linear = line.joint < kLinearJoints;
  double finer = line.spacing;
  const auto spacing = [&](int n) {
    return linear && rules.power_of_two ? std::ldexp(kGridStep, n)
                                        : round_series(linear ? mm : deg, n);
  };
  for (int n = 0; spacing(n) < line.spacing * (1.0 - kSlack); ++n) finer = spacing(n);
  if (finer == line.spacing || points_over(length, finer) > most_points) return std::nullopt;
  line.spacing = finer;
  line.points = points_over(length, finer);
  return line;
}

bool CompensationTable::is_angle() const {
  return component ? !is_linear(component->direction) : output >= kLinearJoints;
}

double CompensationTable::at(double entry, int direction) const {
  const std::vector<double>& e = direction < 0 && depends_on_direction() ? error_down : error;
  const double u =
      std::clamp((entry - line.first) / line.spacing, 0.0, static_cast<double>(e.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(u), e.size() - 2);
  return e[i] + (u - static_cast<double>(i)) * (e[i + 1] - e[i]);
}

double CompensationTable::largest() const {
  double most = 0.0;
  for (const auto* values : {&error, &error_down}) {
    for (const double e : *values) most = std::max(most, std::abs(e));
  }
  return most;
}

double CompensationTable::steepest() const {
  double most = 0.0;
  for (const auto* values : {&error, &error_down}) {
    for (std::size_t i = 0; i + 1 < values->size(); ++i) {
      most = std::max(most, std::abs((*values)[i + 1] - (*values)[i]) / line.spacing);
    }
  }
  return most;
}

std::vector<CompensationTable> tables_of(const TableSource& source,
                                         const std::vector<TableLine>& lines,
                                         const FormatRules& rules) {
  const LineCorrection correction(source), small(scaled_down(source));
  std::vector<CompensationTable> out;
  Stage stage("axes", static_cast<double>(lines.size()), Steps::unlike);
  for (const TableLine& line : lines) {
    stage.advance();
    if (!line.wanted) continue;
    for (int output = 0; output < kJoints; ++output) {
      const bool own = output == line.joint;
      if (!own && (!rules.cross || line.joint >= kLinearJoints || output >= kLinearJoints))
        continue;
      const double step = output < kLinearJoints ? rules.length_step : rules.angle_step;
      const bool by_direction = (own || rules.direction == DirectionRule::all) &&
                                correction.depends_on_direction(line.joint);
      CompensationTable table = tabulate(
          line,
          [&](double q, int direction) {
            return -correction.over(line.joint, q, direction)[output];
          },
          step, by_direction);
      if (table.error == table.error_down) table.error_down.clear();
      table.output = output;
      if (!holds_anything(table)) continue;
      refuse_jump(source, table);
      table.is_second_order = !table.depends_on_direction() && table.largest() <= kSecondOrder &&
                              is_zero_to_first_order(small, table, step);
      out.push_back(std::move(table));
    }
  }
  return out;
}

std::vector<CompensationTable> component_tables_of(const TableSource& source,
                                                   const std::vector<TableLine>& lines,
                                                   const FormatRules& rules) {
  std::vector<CompensationTable> out;
  for (const TableLine& line : lines) {
    if (!line.wanted) continue;
    const Axis axis = *source.chain.layout.axis[static_cast<std::size_t>(line.joint)];
    for (const Axis direction : kAllAxes) {
      const plant::ErrorName name{direction, axis, false};
      const plant::ErrorFunction& error = source.errors.component(name);
      if (!rules.tool_side && error.is_zero()) continue;
      if (needs_grid(source, rules, name)) continue;  // grid_tables_of
      const Curve own = [&](double q, int travel) {
        return component_on_line(source, name, q, travel);
      };
      const Curve converted = [&](double q, int) {
        AxisWords words = source.chain.layout.words(source.reference);
        words[index_of(axis)] = q;
        return written_error(source, rules, name, words);
      };
      const bool by_direction = rules.direction != DirectionRule::none && !error.reversals.empty();
      CompensationTable table =
          tabulate(line, rules.tool_side ? converted : own,
                   is_linear(direction) ? rules.length_step : rules.angle_step, by_direction);
      if (rules.tool_side && !holds_anything(table)) continue;
      table.output = line.joint;
      table.component = name;
      out.push_back(std::move(table));
    }
  }
  return out;
}

}  // namespace servomill::sim::tables

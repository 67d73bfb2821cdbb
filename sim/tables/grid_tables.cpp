#include "sim/tables/grid_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "plant/vocabulary/input_error.h"
#include "plant/vocabulary/interrupt.h"
#include "plant/vocabulary/units.h"
#include "sim/tables/for_all_points.h"
#include "sim/tables/tool_side_errors.h"

namespace servomill::sim::tables {
namespace {

constexpr double kMaxRecords = 1e6;
constexpr int kPartsOfCurve = 4;        // of an interval in which the error is not linear
constexpr int kPoses = 4096;            // at which the residual is looked for
constexpr double kPositionStep = 1e-6;  // mm, deg: last digit written

double coordinate_unit(Axis axis) { return is_linear(axis) ? mm : deg; }

const TableLine& line_of(const TableSource& source, const std::vector<TableLine>& lines,
                         Axis axis) {
  const int joint = source.chain.layout.joint_of(axis).value();
  return *std::find_if(lines.begin(), lines.end(),
                       [&](const TableLine& line) { return line.joint == joint; });
}

bool is_converted(const TableSource& source, const FormatRules& rules, Axis axis) {
  return rules.tool_side && !is_as_ours(source.chain.at(axis));
}

// Errors of the axis that the value of one depends on.
std::vector<const plant::ErrorFunction*> functions_behind(const TableSource& source,
                                                          const FormatRules& rules,
                                                          const plant::ErrorName& name) {
  std::vector<const plant::ErrorFunction*> out;
  for (const Axis direction : kAllAxes) {
    if (direction != name.direction && !is_converted(source, rules, name.axis)) continue;
    out.push_back(&source.errors.component({direction, name.axis, false}));
  }
  return out;
}

bool depends_on(const plant::ErrorFunction& f, Axis axis) {
  return std::any_of(f.grids.begin(), f.grids.end(),
                     [&](const plant::GridFunction& g) { return g.depends_on(axis); });
}

// Arguments, the axis of the error last.
std::vector<Axis> arguments_of(const TableSource& source, const FormatRules& rules,
                               const plant::ErrorName& name) {
  std::vector<Axis> axes;
  const auto functions = functions_behind(source, rules, name);
  for (const Axis axis : kAllAxes) {
    if (axis == name.axis) continue;
    const bool is_argument = std::any_of(functions.begin(), functions.end(),
                                         [&](const auto* f) { return depends_on(*f, axis); });
    if (is_argument) axes.push_back(axis);
  }
  axes.push_back(name.axis);
  return axes;
}

// Linear between the positions of its grids, as far as one argument goes.
bool is_linear_between(const plant::ErrorFunction& f, Axis argument, Axis own) {
  const bool is_spline = std::any_of(f.grids.begin(), f.grids.end(), [&](const auto& g) {
    return g.depends_on(argument) && g.points().interpolation == plant::GridInterpolation::cubic;
  });
  const bool has_terms = f.polynomial.size() > 2 || !f.harmonics.empty() || !f.tables.empty();
  return !is_spline && !(argument == own && has_terms);
}

double rounded(double position, Axis axis) {
  return std::round(position / coordinate_unit(axis) / kPositionStep) * kPositionStep *
         coordinate_unit(axis);
}

using Positions = std::set<double>;

// Adds a position within the travel, as written.
void add_within(const TableLine& line, Axis argument, double q, Positions& at) {
  if (q > line.from && q < line.to) at.insert(rounded(q, argument));
}

void add_grid_points(const TableLine& line, Axis argument, const plant::ErrorFunction& f,
                     Positions& at) {
  for (const plant::GridFunction& g : f.grids) {
    const auto place = std::find(g.axes().begin(), g.axes().end(), argument);
    if (place == g.axes().end()) continue;
    const auto k = static_cast<std::size_t>(place - g.axes().begin());
    const std::vector<double>& points = g.points().at[k];
    const bool repeats = !g.points().repeats.empty() && g.points().repeats[k];
    const double span = points.back() - points.front();
    const double first = repeats ? std::floor((line.from - points.front()) / span) : 0.0;
    const double last = repeats ? std::floor((line.to - points.front()) / span) : 0.0;
    for (double turn = first; turn <= last; ++turn) {
      for (const double q : points) add_within(line, argument, q + turn * span, at);
    }
  }
}

std::vector<double> in_parts(const Positions& at, int parts, Axis argument) {
  std::vector<double> out = {*at.begin()};
  for (auto next = std::next(at.begin()); next != at.end(); ++next) {
    const double from = out.back(), width = *next - from;
    for (int i = 1; i < parts; ++i) out.push_back(rounded(from + width * i / parts, argument));
    out.push_back(*next);
  }
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

// Positions of one argument: ends of the travel, points of the grids, and more on curves.
std::vector<double> positions_of(const TableSource& source, const FormatRules& rules,
                                 const std::vector<TableLine>& lines, const plant::ErrorName& name,
                                 Axis argument) {
  const TableLine& line = line_of(source, lines, argument);
  const bool is_own = argument == name.axis;
  Positions at = {rounded(line.from, argument), rounded(line.to, argument)};
  // a conversion multiplies angles by the position of a linear axis and turns with a rotary one
  bool is_curved = is_own && is_converted(source, rules, name.axis);
  for (const plant::ErrorFunction* f : functions_behind(source, rules, name)) {
    is_curved = is_curved || !is_linear_between(*f, argument, name.axis);
    add_grid_points(line, argument, *f, at);
  }
  for (std::size_t i = 0; is_own && is_curved && i < line.points; ++i) {
    add_within(line, argument, line.entry(i), at);
  }
  return in_parts(at, is_curved ? kPartsOfCurve : 1, argument);
}

// "EZX", or of a converted axis all errors of which the grid is made: "EXX from EYX, EZX".
std::string origin_of(const TableSource& source, const FormatRules& rules,
                      const plant::ErrorName& name) {
  if (!is_converted(source, rules, name.axis)) return to_string(name);
  std::string others;
  for (const Axis direction : kAllAxes) {
    const plant::ErrorName one{direction, name.axis, false};
    if (source.errors.component(one).grids.empty()) continue;
    if (one == name) return to_string(name);
    others += fmt::format("{}{}", others.empty() ? "" : ", ", to_string(one));
  }
  return fmt::format("{} from {}", to_string(name), others);
}

void refuse_size(const TableSource& source, const FormatRules& rules, const plant::ErrorName& name,
                 const plant::GridPoints& points) {
  double records = 1.0;
  for (const auto& at : points.at) records *= static_cast<double>(at.size());
  if (records <= kMaxRecords) return;
  throw InputError(
      {}, fmt::format("{} over {} axes: a grid of {:.15g} records; at most {:.15g} are written; "
                      "choose a larger --spacing, or fewer positions in the model's grid",
                      origin_of(source, rules, name), points.axes.size(), records, kMaxRecords));
}

GridTable tabulate(const TableSource& source, const std::vector<TableLine>& lines,
                   const FormatRules& rules, const plant::ErrorName& name) {
  GridTable table{name, {}, 0.0};
  table.points.axes = arguments_of(source, rules, name);
  for (const Axis axis : table.points.axes) {
    table.points.at.push_back(positions_of(source, rules, lines, name, axis));
  }
  refuse_size(source, rules, name, table.points);
  const double step = table.is_angle() ? rules.angle_step : rules.length_step;
  AxisWords q = source.chain.layout.words(source.reference);
  for_all_points(table.points, 0, q, [&](const AxisWords& at) {
    throw_if_interrupted();
    const double exact = written_error(source, rules, name, at);
    table.points.error.push_back(std::round(exact / step) * step + 0.0);
  });
  const plant::GridFunction written(table.points);
  for (int n = 1; n <= kPoses; ++n) {
    const AxisWords at = source.chain.layout.words(spread_pose(source, lines, n));
    table.residual = std::max(table.residual,
                              std::abs(written.value(at) - written_error(source, rules, name, at)));
  }
  return table;
}

// Names an error of that axis which depends on another one.
void refuse_other_axes(const TableSource& source, Axis axis) {
  for (const Axis direction : kAllAxes) {
    const plant::ErrorName name{direction, axis, false};
    for (const Axis other : source.errors.component(name).grid_axes()) {
      if (other == axis) continue;
      throw InputError(
          {},
          fmt::format("{} depends on the position of {}, too; this format contains functions of "
                      "the position of {} only; use --format isg",
                      to_string(name), letter(other), letter(axis)));
    }
  }
}

}  // namespace

double GridTable::largest() const {
  double most = 0.0;
  for (const double e : points.error) most = std::max(most, std::abs(e));
  return most;
}

bool needs_grid(const TableSource& source, const FormatRules& rules, const plant::ErrorName& name) {
  return arguments_of(source, rules, name).size() > 1;
}

double written_error(const TableSource& source, const FormatRules& rules,
                     const plant::ErrorName& name, const AxisWords& q) {
  const double s = q[index_of(name.axis)];
  if (!rules.tool_side) return source.errors.component(name).value(s, q);
  ComponentErrors ours;
  for (const Axis a : kAllAxes) {
    part_of(ours, a) = source.errors.component({a, name.axis, false}).value(s, q);
  }
  ComponentErrors theirs = tool_side(source.chain.at(name.axis), ours, s);
  return part_of(theirs, name.direction);
}

std::vector<GridTable> grid_tables_of(const TableSource& source,
                                      const std::vector<TableLine>& lines,
                                      const FormatRules& rules) {
  std::vector<GridTable> out;
  for (const TableLine& line : lines) {
    if (!line.wanted) continue;
    const Axis axis = *source.chain.layout.axis[static_cast<std::size_t>(line.joint)];
    for (const Axis direction : kAllAxes) {
      const plant::ErrorName name{direction, axis, false};
      if (!needs_grid(source, rules, name)) continue;
      if (!rules.grids) refuse_other_axes(source, axis);
      GridTable table = tabulate(source, lines, rules, name);
      if (table.largest() > 0.0) out.push_back(std::move(table));
    }
  }
  return out;
}

Joints spread_pose(const TableSource& source, const std::vector<TableLine>& lines, int n) {
  // n (1/g, 1/g^2, ...) modulo 1: fills the travel evenly and repeats on no axis
  constexpr double g = 1.1347241384015194;  // g^6 = g + 1, for up to five axes
  Joints Q = source.reference;
  double step = 1.0;
  for (const TableLine& line : lines) {
    step /= g;
    double whole = 0.0;
    Q[line.joint] = line.from + (line.to - line.from) * std::modf(n * step, &whole);
  }
  return Q;
}

}  // namespace servomill::sim::tables

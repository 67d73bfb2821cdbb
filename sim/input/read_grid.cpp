#include "sim/input/read_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "plant/vocabulary/units.h"
#include "sim/model/machine.h"

namespace servomill::sim::input {
namespace {

using plant::GridInterpolation;
using plant::GridPoints;

double unit_of(Axis axis) { return is_linear(axis) ? mm : deg; }

// Letters of axes of the machine.
std::vector<Axis> read_axes(config::Reader& table, const JointLayout& layout) {
  std::vector<Axis> axes;
  const std::size_t faults = table.faults();
  const std::string text = table.text("axes");
  for (const char c : text) {
    const auto axis = axis_of(c);
    if (axis && layout.joint_of(*axis)) {
      axes.push_back(*axis);
      continue;
    }
    std::string letters;
    for (const auto& a : layout.axis) {
      if (a) letters += letter(*a);
    }
    table.fault("axes", fmt::format("must consist of axes of the machine, which has {}", letters));
    return {};
  }
  if (axes.empty() && table.faults() == faults) table.fault("axes", "must name at least one axis");
  return axes;
}

// The unit is part of the key, and one key holds the positions of all axes.
std::string positions_key(const std::vector<Axis>& axes) {
  const auto linear = std::count_if(axes.begin(), axes.end(), is_linear);
  if (linear == std::ssize(axes)) return "at_mm";
  return linear == 0 ? "at_deg" : "at_mm_deg";
}

std::vector<std::vector<double>> read_positions(config::Reader& table, const std::string& key,
                                                const std::vector<Axis>& axes) {
  std::vector<std::vector<double>> at = table.rows(key);
  for (std::size_t k = 0; k < std::min(at.size(), axes.size()); ++k) {
    for (double& position : at[k]) position *= unit_of(axes[k]);
  }
  return at;
}

// An axis without limits turns on: its errors repeat after a turn.
bool covers_turn(config::Reader& table, const std::string& key, Axis axis, double from, double to) {
  constexpr double kSlack = 1e-9;  // rad: rounding of units
  if (std::abs(to - from - 360 * deg) <= kSlack) return true;
  table.fault(key, fmt::format("must cover one turn of {}, whose travel is endless: 360 deg; "
                               "covers {:g} to {:g}",
                               letter(axis), from / deg, to / deg));
  return false;
}

bool covers_travel(config::Reader& table, const std::string& key, const GridPoints& points,
                   const MachineAxes& machine) {
  constexpr double kSlack = 1e-9;  // m, rad: rounding of units
  for (std::size_t k = 0; k < points.axes.size(); ++k) {
    const Axis axis = points.axes[k];
    const int joint = machine.layout.joint_of(axis).value();
    const double unit = unit_of(axis), from = points.at[k].front(), to = points.at[k].back();
    const double lower = machine.lower[joint], upper = machine.upper[joint];
    if (machine.is_endless(axis)) {
      if (!covers_turn(table, key, axis, from, to)) return false;
      continue;
    }
    const bool starts = !std::isfinite(lower) || from <= lower + kSlack;
    const bool ends = !std::isfinite(upper) || to >= upper - kSlack;
    if (starts && ends) continue;
    table.fault(
        key, fmt::format("must cover the travel of {}, {:g} to {:g} {}; covers {:g} to {:g}",
                         letter(axis), lower / unit, upper / unit, is_linear(axis) ? "mm" : "deg",
                         from / unit, to / unit));
    return false;
  }
  return true;
}

}  // namespace

MachineAxes::MachineAxes(const JointLayout& axes) : layout(axes) {
  lower.setConstant(-std::numeric_limits<double>::infinity());
  upper.setConstant(std::numeric_limits<double>::infinity());
}

MachineAxes::MachineAxes(const model::MachineSettings& machine)
    : layout(machine.chain.layout),
      lower(machine.nc.lower),
      upper(machine.nc.upper),
      is_travel_known(true) {}

bool MachineAxes::is_endless(Axis axis) const {
  const auto joint = layout.joint_of(axis);
  return is_travel_known && joint && !is_linear(axis) && !std::isfinite(lower[*joint]) &&
         !std::isfinite(upper[*joint]);
}

plant::ErrorFunction read_grid(config::Reader& table, bool is_length, const MachineAxes& machine) {
  constexpr std::array<std::string_view, 2> kInterpolations = {"linear", "cubic"};
  const std::size_t faults = table.faults();
  GridPoints points;
  points.axes = read_axes(table, machine.layout);
  if (points.axes.empty()) {  // the other keys depend on them
    table.skip_rest();
    return {};
  }
  const std::string at = positions_key(points.axes), value = is_length ? "value_um" : "value_urad";
  points.at = read_positions(table, at, points.axes);
  std::vector<std::size_t> shape;
  std::vector<double> units;
  for (const auto& positions : points.at) shape.push_back(positions.size());
  for (const Axis axis : points.axes) units.push_back(unit_of(axis));
  points.error = table.nested(value, shape);
  for (double& error : points.error) error *= um;  // um is urad
  points.interpolation =
      static_cast<GridInterpolation>(table.choice_or("interpolation", 0, kInterpolations));
  if (table.faults() > faults) {
    table.skip_rest();
    return {};
  }
  for (std::size_t k = 0; k < points.axes.size(); ++k) {
    if (!machine.is_endless(points.axes[k])) continue;
    points.repeats.resize(points.axes.size(), false);
    points.repeats[k] = true;
  }
  if (const auto fault = grid_fault(points, units)) {
    table.fault(*fault);
    return {};
  }
  if (!covers_travel(table, at, points, machine)) return {};
  return plant::grid(std::move(points));
}

}  // namespace servomill::sim::input
